"""`airlight compare`: techniques against the unbiased reference, in numbers and images."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ...errors import SettingsError
from ..options import (
    Number,
    adapter_option,
    output_option,
    quiet_option,
    samples_option,
    settings_option,
    size_option,
    together,
)
from ..outputs import check_outputs, make_folder, write_json
from ..progress import progress
from ..scene_argument import load_scene, reads, show_warnings, warn
from ..scene_options import scene_options
from .judging import USUAL_PX, Plan, compare_scene

if TYPE_CHECKING:
    from .result import Comparison

TECHNIQUE_OPTIONS = ("-t", "--technique")


class _ManyTechniques(click.Command):
    """Lets `--technique a b c` name several, which click's options cannot."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        options = [p for p in self.params if isinstance(p, click.Option) and not p.is_flag]
        return super().parse_args(ctx, _one_each(args, {o for p in options for o in p.opts}))


def _one_each(args: list[str], valued: Collection[str]) -> list[str]:
    """`--technique a b` as `--technique a --technique b`; other arguments as they are.

    `valued` are the options that take a value. Where no other word could be SCENE, the last
    word of the last group is.
    """
    groups: list[list[str]] = []
    rest: list[str] = []
    has_scene = is_open = False
    # Words that follow --technique are its names until an option comes.
    for arg, before in zip(args, ["", *args], strict=False):
        if arg in TECHNIQUE_OPTIONS:
            groups.append([])
            is_open = True
        elif is_open and not arg.startswith("-"):
            groups[-1].append(arg)
        else:
            is_open = False
            rest.append(arg)
            has_scene |= not arg.startswith("-") and before not in valued
    # A SCENE that stands behind the names was taken for one of them.
    if groups and len(groups[-1]) > 1 and not has_scene:
        rest.insert(0, groups[-1].pop())
    spread = [part for group in groups for name in group for part in ("--technique", name)]
    return rest + spread


_REFERENCE = together(
    click.option(
        "--spp",
        type=click.IntRange(4, 65536),
        default=64,
        show_default=True,
        help="Samples a pixel of the reference, at least.",
    ),
    click.option(
        "--noise",
        type=Number(0.0, min_open=True),
        metavar="RELMSE",
        help="Sample until the reference's noise floor is below this.",
    ),
    click.option(
        "--timeout",
        "timeout_s",
        type=Number(1.0),
        default=3600.0,
        show_default=True,
        help="Seconds the reference may take.",
    ),
)


@click.command("compare", cls=_ManyTechniques)
@click.option(
    "-t",
    "--technique",
    "techniques",
    multiple=True,
    metavar="NAME ...",
    help="Techniques to judge.  [default: direct auto]",
)
@output_option("DIR", "Folder for index.html, contact_sheet.png and results.json.")
@_REFERENCE
@settings_option("A setting of each technique that has it; may be repeated.")
@adapter_option()
@size_option("those of the file's film, or as many as 640x360 in its shape")
@samples_option(16, "Jittered samples a pixel of each technique.")
@scene_options()
@quiet_option()
def command(
    scene: str, techniques: tuple[str, ...], output: Path, quiet: bool, **options: Any
) -> None:
    """Judge techniques on SCENE by an unbiased reference.

    \b
    airlight compare builtin:cornell --technique direct lpv -o comparison/
    airlight compare builtin:cornell -t direct lpv -D resolution=48 -o finer/

    The reference comes from Mitsuba (pip install 'airlight[reference]') and is cached on
    disk by the scene's content.
    """
    from ...techniques import technique_settings

    # What can be refused is refused before minutes of path tracing.
    names = tuple(dict.fromkeys(techniques)) or ("direct", "auto")
    for name in names:
        technique_settings(name)
    reads(scene)
    make_folder(output)
    check_outputs(*_files(output))
    # The scene may name files that the comparison would replace: checked again once it is read.
    with progress(quiet=quiet) as report:
        report("loading", 0.0)
        loaded = load_scene(scene, options["model"])
        check_outputs(*_files(output))
        size = options["size"] or loaded.camera.size_within(USUAL_PX)
        plan = Plan(**{**options, "size": size})
        comparison = compare_scene(loaded, scene, names, plan, output=output, report=report)
        report("writing", 0.0)
        write(comparison, output)
    show_warnings(loaded)
    warn([text for text in [comparison.reference.not_cached] if text])
    _say(comparison, output)


def write(comparison: Comparison, folder: Path) -> None:
    """index.html, contact_sheet.png and results.json, each whole or not at all."""
    from ...scene.io.writing import whole_file
    from .images import png_bytes
    from .page import page, sheet

    # Each file appears when it is complete: numbers, the sheet of images, and the page.
    results, contact, index = _files(folder)
    write_json(comparison.to_json(), results)
    with whole_file(contact) as part:
        part.write_bytes(png_bytes(sheet(comparison)))
    with whole_file(index) as part:
        part.write_text(page(comparison), encoding="utf-8")


def _files(folder: Path) -> tuple[Path, Path, Path]:
    return folder / "results.json", folder / "contact_sheet.png", folder / "index.html"


def _say(comparison: Comparison, folder: Path) -> None:
    """The numbers on stdout, failures on stderr; SettingsError where no technique worked."""
    from .page import number

    # A line for each technique; one that failed is a warning, and an error only if all did.
    for o in comparison.outcomes:
        if o.metrics is not None:
            m = o.metrics
            click.echo(
                f"{o.technique}: relmse {number(m.relmse)}, "
                f"energy {number(m.energy_ratio)}, flip {number(m.flip)}"
            )
        else:
            click.echo(f"warning: {o.technique} made no image: {o.error}", err=True)
    click.echo(str(folder / "index.html"))
    if all(o.error for o in comparison.outcomes):
        raise SettingsError("no technique made an image", where=folder / "index.html")
