"""`airlight scenes`: the built-in scenes."""

from __future__ import annotations

import click

from .outputs import json_text


@click.command("scenes")
@click.option("--json", "as_json", is_flag=True, help="For a machine to read.")
def command(as_json: bool) -> None:
    """List the built-in scenes."""
    known = descriptions()
    if as_json:
        click.echo(json_text(known))
        return
    width = max(map(len, known))
    for name, text in known.items():
        click.echo(f"{name:<{width}}  {text}")


def descriptions() -> dict[str, str]:
    """builtin:NAME and what it shows: the first line of its function's docstring."""
    from ..scene.builtin import BUILTIN
    from ..scene.io import BUILTIN_PREFIX

    return {
        f"{BUILTIN_PREFIX}{name}": (make.__doc__ or "").strip().partition("\n")[0]
        for name, make in BUILTIN.items()
    }
