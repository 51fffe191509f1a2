"""`airlight scenes`: the built-in scenes."""

from __future__ import annotations

import click

from .outputs import json_text
from .scene_argument import BUILTIN


@click.command("scenes")
@click.option("--json", "as_json", is_flag=True, help="For a machine to read.")
def command(as_json: bool) -> None:
    """List the built-in scenes."""
    from ..scene.builtin import descriptions

    known = descriptions()
    if as_json:
        click.echo(json_text({f"{BUILTIN}{name}": text for name, text in known.items()}))
        return
    width = max(map(len, known), default=0)
    for name, text in known.items():
        click.echo(f"{BUILTIN}{name:<{width}}  {text}")
