"""`airlight render`: a scene in, a picture out."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import env
from ..errors import SettingsError
from .outputs import check_writable, write_json
from .progress import progress
from .scene_argument import load_scene, show_warnings

if TYPE_CHECKING:
    from ..scene.image import Image

_STARTED_S = time.perf_counter()
LARGEST_SIDE_PX = 16384


class _Size(click.ParamType):
    """WIDTHxHEIGHT in pixels."""

    name = "WxH"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[int, int]:
        if isinstance(value, tuple):
            return value
        parts = value.lower().split("x")
        if len(parts) != 2 or not all(part.isascii() and part.isdigit() for part in parts):
            self.fail(f"'{value}' is not a size such as 1280x720", param, ctx)
        width_px, height_px = (int(part[:9]) for part in parts)
        if not (1 <= width_px <= LARGEST_SIDE_PX and 1 <= height_px <= LARGEST_SIDE_PX):
            self.fail(
                f"'{value}' is outside 1x1 to {LARGEST_SIDE_PX}x{LARGEST_SIDE_PX}", param, ctx
            )
        return width_px, height_px


class _Setting(click.ParamType):
    """key=value."""

    name = "key=value"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[str, str]:
        if isinstance(value, tuple):
            return value
        key, equals, text = value.partition("=")
        if not equals or not key.strip():
            self.fail(f"'{value}' is not written as key=value", param, ctx)
        return key.strip().replace("-", "_"), text.strip()


@click.command("render")
@click.argument("scene")
@click.option(
    "-o",
    "--output",
    required=True,
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Picture to write: .exr and .hdr are linear, .png and .jpg tone mapped.",
)
@click.option(
    "-t",
    "--technique",
    default="auto",
    show_default=True,
    help="auto (the full composition), direct, single, lpv, lpv-scatter, pop ...",
)
@click.option("--size", type=_Size(), default=(1280, 720), help="Pixels.  [default: 1280x720]")
@click.option("--samples", type=click.IntRange(1, 4096), help="Jittered samples per pixel.")
@click.option("-D", "settings", multiple=True, type=_Setting(), help="A setting of the technique.")
@click.option("--layers", is_flag=True, help="Keep every layer in the EXR.")
@click.option(
    "--stats",
    type=click.Path(path_type=Path),
    metavar="FILE.json",
    help="Write device, timings and sizes as JSON.",
)
@click.option(
    "--adapter",
    default=lambda: env.value("AIRLIGHT_ADAPTER"),
    metavar="NAME",
    help="auto, cpu, gpu or a part of the adapter's name.  [default: auto]",
)
@click.option(
    "--exposure", type=click.FloatRange(-64, 64), metavar="STOPS", help="Instead of the camera's."
)
@click.option(
    "--tone-map",
    type=click.Choice(["agx", "aces", "neutral", "none"]),
    help="Display curve.  [default: agx]",
)
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def command(scene: str, output: Path, **options: Any) -> None:
    """Render SCENE into a picture.

    \b
    airlight render builtin:atrium -o atrium.png
    airlight render room.toml -o room.exr --layers -t lpv -D resolution=48
    """
    stats_path: Path | None = options["stats"]
    _check_outputs(output, stats_path, options["layers"])
    with progress(quiet=options["quiet"]) as report:
        report("loading", 0.0)
        started_s = time.perf_counter()
        loaded = load_scene(scene)
        load_s = time.perf_counter() - started_s
        image = _rendered(loaded, options, report)
        first_image_s = time.perf_counter() - _STARTED_S
        report("writing", 0.0)
        image.save(output, layers=options["layers"])
        if stats_path is not None:
            timed = {"load_s": load_s, "first_image_s": first_image_s}
            write_json({**image.stats, **timed}, stats_path)
    show_warnings(loaded)
    click.echo(str(output))


def _check_outputs(output: Path, stats_path: Path | None, layers: bool) -> None:
    """Refuse, before any work, what could not be written after it."""
    from ..scene.io.images import PICTURE_SUFFIXES

    check_writable(output, PICTURE_SUFFIXES)
    if layers and output.suffix.lower() != ".exr":
        raise SettingsError(
            f"--layers needs an .exr, {output.suffix} holds one picture", where=output
        )
    if stats_path is not None:
        check_writable(stats_path)
        if stats_path.resolve() == output.resolve():
            raise SettingsError("--stats and -o name the same file", where=output)


def _rendered(scene: Any, options: dict[str, Any], report: Any) -> Image:
    from ..render import render

    image = render(
        scene,
        technique=options["technique"],
        size=options["size"],
        settings=dict(options["settings"]),
        adapter=options["adapter"],
        progress=report,
        **({"samples": options["samples"]} if options["samples"] else {}),
    )
    if options["exposure"] is not None:
        image = replace(image, exposure_stops=options["exposure"])
    if options["tone_map"] is not None:
        image = replace(image, tone_map=options["tone_map"])
    return image
