"""`airlight convert`: a scene to Mitsuba XML, or a picture to another format."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from ..errors import SettingsError
from .outputs import check_writable
from .scene_argument import load_scene, show_warnings

LINEAR_SUFFIXES = (".exr", ".hdr", ".pic", ".rgbe")
DISPLAY_SUFFIXES = (".png", ".jpg", ".jpeg")
PICTURES_OUT = (".exr", ".hdr", *DISPLAY_SUFFIXES)
SCENES_OUT = (".xml",)


@click.command("convert")
@click.argument("source", metavar="IN")
@click.argument("target", metavar="OUT", type=click.Path(path_type=Path))
@click.option(
    "--exposure", type=click.FloatRange(-64, 64), metavar="STOPS",
    help="For .png and .jpg of a linear picture.  [default: 0]",
)  # fmt: skip
@click.option(
    "--tone-map", type=click.Choice(["agx", "aces", "neutral", "none"]),
    help="Display curve.  [default: agx of a linear picture, none of an 8-bit one]",
)  # fmt: skip
def command(source: str, target: Path, exposure: float | None, tone_map: str | None) -> None:
    """Convert a scene or a picture.

    \b
    airlight convert room.toml room.xml     any scene to Mitsuba 3
    airlight convert room.exr room.png      pictures: .exr .hdr .png .jpg
    """
    suffix = Path(source).suffix.lower()
    if suffix in (*LINEAR_SUFFIXES, *DISPLAY_SUFFIXES):
        check_writable(target, PICTURES_OUT)
        convert_picture(Path(source), target, exposure, tone_map)
    elif exposure is not None or tone_map is not None:
        raise SettingsError("--exposure and --tone-map are for pictures", where=source)
    else:
        convert_scene(source, target)
    click.echo(str(target))


def convert_picture(
    source: Path, target: Path, exposure: float | None = None, tone_map: str | None = None
) -> None:
    """Write the picture at `source` in the format of `target`'s ending.

    EXR keeps its layers in EXR. An 8-bit picture is decoded from sRGB, nothing more: it is shown
    without a curve unless `tone_map` names one. Raises SceneError, OutputError.
    """
    from ..scene.io.images import load_image, save_image

    image = load_image(source)
    if source.suffix.lower() in DISPLAY_SUFFIXES:
        image = replace(image, tone_map="none")
    if exposure is not None:
        image = replace(image, exposure_stops=exposure)
    if tone_map is not None:
        image = replace(image, tone_map=tone_map)
    save_image(image, target)


def convert_scene(source: str, target: Path) -> None:
    """Write the scene that `source` names as Mitsuba XML, saying what was approximated.

    Raises SceneError, OutputError, ReferenceFailure, and SettingsError for another format.
    """
    if target.suffix.lower() not in SCENES_OUT:
        raise SettingsError(
            f"a scene cannot be written as '{target.suffix}'",
            where=target,
            remedy="End its name in .xml, for Mitsuba 3.",
        )
    check_writable(target)
    if target.resolve() == Path(source).resolve():
        raise SettingsError("IN and OUT are the same file", where=target)
    from ..reference.mitsuba import write_mitsuba

    scene = load_scene(source)
    notes = write_mitsuba(scene, target)
    show_warnings(scene)
    for note in notes:
        click.echo(f"note: {note}", err=True)
