"""`airlight figure`: the papers' figures, ours, with the numbers behind them."""

from __future__ import annotations

import shlex
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import __version__, env
from ..errors import AirlightError, SettingsError
from .options import (
    adapter_option,
    output_option,
    quiet_option,
    size_option,
)
from .outputs import make_folder
from .progress import progress

if TYPE_CHECKING:
    from .progress import Report

SIZE, QUICK_SIZE = (640, 360), (96, 54)


@click.command("figure")
@click.argument("names", nargs=-1, metavar="[NAME ...]")
@click.option("--all", "is_all", is_flag=True, help="Every figure.")
@click.option(
    "--gallery",
    "is_gallery",
    is_flag=True,
    help="Write index.html over all figures in DIR; --all does, too.",
)
@click.option("--list", "is_list", is_flag=True, help="Name them and stop.")
@output_option("DIR", "Folder for NAME.png and NAME.json.", is_required=False)
@size_option("640x360")
@click.option("--quick", is_flag=True, help="Tiny lattices and images: does it work?")
@adapter_option()
@quiet_option()
def command(
    names: tuple[str, ...],
    is_all: bool,
    is_gallery: bool,
    is_list: bool,
    output: Path | None,
    **options: Any,
) -> None:
    """Draw figures of the papers: an image and the JSON of its numbers each.

    \b
    airlight figure --list
    airlight figure clpv-5 clpv-6 -o figures/
    airlight figure --all -o figures/        and a page of all of them, figures/index.html

    Path-traced panels need Mitsuba (pip install 'airlight[reference]') and are cached on disk.
    """
    from ..figures.gallery import write_gallery
    from ..figures.registry import FIGURES, figure

    if options["quick"] and options["size"]:
        raise click.UsageError("--quick has a size of its own: leave out --size")
    if is_list:
        _list()
        return
    # Unknown names are refused before the first figure is drawn.
    chosen = tuple(FIGURES) if is_all else tuple(dict.fromkeys(names))
    if not chosen and not is_gallery:
        raise SettingsError("no figure is named", remedy=f"Name some of {', '.join(FIGURES)}")
    for name in chosen:
        figure(name)
    folder = _folder(output)
    size = QUICK_SIZE if options["quick"] else options["size"] or SIZE
    # Each figure with its numbers, then the page of all that lie in the folder.
    with progress(quiet=options["quiet"]) as report:
        failed = _draw_all(chosen, folder, size, options, report)
    if is_all or is_gallery:
        click.echo(str(write_gallery(folder)))
    _complain(failed, len(chosen))


def _draw_all(
    names: tuple[str, ...],
    folder: Path,
    size: tuple[int, int],
    options: dict[str, Any],
    report: Report,
) -> dict[str, Exception]:
    """Each figure; one that cannot be drawn does not cost the others, whoever made the mistake."""
    from ..figures.panels import Request
    from ..figures.registry import figure, keep

    failed: dict[str, Exception] = {}
    for name in names:
        report(name, 0.0)

        def told(stage: str, fraction: float, name: str = name) -> None:
            report(f"{name}: {stage}", fraction)

        # What a panel lacks (Mitsuba, a file) is noted by it and said once for the figure.
        lacks: dict[str, None] = {}  # several panels may lack the same
        request = Request(size, options["quick"], options["adapter"], told, lacks.setdefault)
        try:
            drawn = figure(name).draw(request)
        except Exception as error:
            failed[name] = error
            if env.is_on("AIRLIGHT_DEBUG") and not isinstance(error, AirlightError):
                traceback.print_exception(error)
            continue
        # With the image goes what is needed to draw it again.
        about = {
            "command": _command(name, folder, size, options["quick"]),
            "airlight": __version__,
            "panel_size": list(size),
        }
        click.echo(str(keep(name, drawn, about, folder)))
        for lack in lacks:
            click.echo(f"warning: {name}: {lack}", err=True)
    return failed


def _command(name: str, folder: Path, size: tuple[int, int], quick: bool) -> str:
    words = ["airlight", "figure", name, "-o", str(folder)]
    return shlex.join(words + (["--quick"] if quick else ["--size", f"{size[0]}x{size[1]}"]))


def _list() -> None:
    from ..figures.registry import FIGURES

    width = max(map(len, FIGURES))
    for name, known in FIGURES.items():
        beside = f" ({known.source})" if known.source else ""
        click.echo(f"{name:<{width}}  {known.shows}{beside}")


def _folder(output: Path | None) -> Path:
    if output is None:
        raise SettingsError("there is no folder to draw into", remedy="Name one: -o DIR")
    make_folder(output)
    return output


def _complain(failed: dict[str, Exception], count: int) -> None:
    """Raise where a figure failed: its own error, or all of them in one message.

    A mistake of ours among several figures is told in words, and ends with exit code 1.
    """
    # One figure that was asked for fails with its own message.
    if len(failed) == 1 and count == 1:
        raise next(iter(failed.values()))
    if not failed:
        return
    said = "; ".join(f"{name}: {_words(error)}" for name, error in failed.items())
    problem = f"{len(failed)} of {count} figures could not be drawn: {said}"
    if all(isinstance(error, AirlightError) for error in failed.values()):
        raise SettingsError(problem)
    # Mistakes of ours among several figures are reported as such.
    click.echo(f"error: {problem}. Please report it, with AIRLIGHT_DEBUG=1.", err=True)
    raise click.exceptions.Exit(1)


def _words(error: Exception) -> str:
    if isinstance(error, AirlightError):
        return str(error)
    text = " ".join(str(error).split()) or "no message"
    return f"internal error: {type(error).__name__}: {text}"
