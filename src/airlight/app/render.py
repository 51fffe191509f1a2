"""`airlight render`: a scene in, an image out."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..errors import AirlightError, SettingsError
from ..scene.io import BUILTIN_PREFIX
from ..scene.io.ledger import noted
from .options import (
    AUTO,
    SECONDS,
    check_settings,
    display_doubts,
    display_options,
    displayed,
    output_option,
    quiet_option,
    samples_option,
    size_option,
    solving_options,
)
from .outputs import check_outputs, check_writable, write_json
from .progress import Report, progress
from .scene_argument import load_scene, reads, show_warnings
from .scene_options import camera_options, scene_options, with_camera, with_exposure
from .streams import say
from .view.watch import INTERVAL_S, Watch

if TYPE_CHECKING:
    from ..scene import Scene

_STARTED_S = time.perf_counter()


@click.command("render")
@output_option("FILE", "Image to write: .exr and .hdr are linear, .png and .jpg tone mapped.")
@solving_options()
@size_option()
@samples_option(None, "Jittered samples per pixel.  [default: 12; media 8; lens or shutter 64]")
@click.option(
    "--time",
    "time_s",
    type=SECONDS,
    metavar="SECONDS",
    help="Of a scene that moves: when.",
)
@camera_options()
@display_options()
@scene_options()
@click.option("--layers", is_flag=True, help="Keep every layer in the EXR.")
@click.option(
    "--stats",
    type=click.Path(path_type=Path),
    metavar="FILE.json",
    help="Write device, timings and sizes as JSON.",
)
@click.option(
    "--watch",
    is_flag=True,
    help="Render again whenever the scene file, or one that it uses, is saved.",
)
@click.option(
    "--denoise",
    is_flag=True,
    help="Remove noise with Open Image Denoise (the extra denoise).",
)
@quiet_option()
def command(scene: str, output: Path, **options: Any) -> None:
    """Render SCENE into an image.

    \b
    airlight render builtin:atrium -o atrium.png
    airlight render room.toml -o room.exr --layers -t lpv -D resolution=48
    airlight render builtin:smoke -o smoke.png --time 2.5
    airlight render 'plume/*.vdb' -o plume.png       grids that follow each other
    airlight render room.toml -o room.png --watch
    """
    reads(scene)
    # Mistakes in options are told before the scene is loaded.
    _check_outputs(output, options["stats"], options["layers"])
    check_settings(options["technique"], options["settings"])
    if options["denoise"]:
        from ..scene.denoise import denoiser

        denoiser()
    if options["watch"]:
        watched(scene, lambda: _rendered(scene, output, options))
    else:
        _rendered(scene, output, options)


def _rendered(scene: str, output: Path, options: dict[str, Any]) -> None:
    """One image into its file. Raises AirlightError."""
    stats_path: Path | None = options["stats"]
    with progress(quiet=options["quiet"]) as report:
        # Loading is timed apart from rendering, as a scene is often loaded once for many images.
        report("loading", 0.0)
        started_s = time.perf_counter()
        loaded = with_camera(load_scene(scene, options["model"]), options["camera"])
        load_s = time.perf_counter() - started_s
        loaded = with_exposure(loaded, options["exposure"])  # which unlit surfaces follow
        # The scene may have read files that the outputs would replace.
        check_outputs(output, stats_path)
        from ..rendering import render

        # The first image is complete when its last sample is, not when it is denoised or written.
        finished_s: list[float] = []
        asked = _asked(loaded, options)
        image = render(loaded, **asked, progress=_stamped(report, finished_s))
        # Where the image set its exposure it has it, unlit surfaces left aside.
        stops = None if options["exposure"] == AUTO else options["exposure"]
        image = displayed(image, {**options, "exposure": stops})
        if options["denoise"]:
            report("denoising", 0.0)
            image = image.denoised()
        # The least of the stamps: with --stats the timing goes on after the image.
        first_image_s = min([*finished_s, time.perf_counter()]) - _STARTED_S
        report("writing", 0.0)
        image.save(output, layers=options["layers"])
        if stats_path is not None:
            timed = {"load_s": load_s, "first_image_s": first_image_s}
            write_json({**image.stats, **timed}, stats_path)
    show_warnings(loaded, (*image.doubts, *display_doubts(output.suffix, options)))
    click.echo(str(output))


def _check_outputs(output: Path, stats_path: Path | None, layers: bool) -> None:
    """Refuse, before any work, what could not be written after it."""
    from ..scene.io.images import IMAGE_SUFFIXES

    check_writable(output, IMAGE_SUFFIXES)
    if layers and output.suffix.lower() != ".exr":
        raise SettingsError(
            f"--layers needs an .exr, {output.suffix} holds one image", where=output
        )
    check_outputs(output, stats_path)


def _stamped(report: Report, finished_s: list[float]) -> Report:
    """`report`, noting when a stage is done: timing goes on after the first image with --stats."""

    def stamped(stage: str, fraction: float) -> None:
        report(stage, fraction)
        if stage == "render" and fraction >= 1.0:
            finished_s.append(time.perf_counter())

    return stamped


def _asked(scene: Scene, options: dict[str, Any]) -> dict[str, Any]:
    """The arguments of `render`, checked against the scene. Raises SettingsError."""
    from ..techniques import checked_settings

    # Mistakes are told before anything is rendered.
    checked_settings(options["technique"], scene, options["settings"])
    if options["time_s"] is not None and scene.animation is None:
        raise SettingsError(f"nothing moves in '{scene.name}'", remedy="Leave --time out.")
    return {
        "technique": options["technique"],
        "size": options["size"] or scene.camera.image_size,
        "settings": options["settings"],
        "adapter": options["adapter"],
        "timed": options["stats"] is not None,
        "time": options["time_s"],
        **({"samples": options["samples"]} if options["samples"] else {}),
    }


def watched(scene: str, work: Callable[[], None]) -> None:
    """`work` now and after each save, until interrupted; its errors are said, and waited out.

    Raises SettingsError for a scene that is no file.
    """
    if scene.startswith(BUILTIN_PREFIX):
        raise SettingsError("--watch is for scene files", remedy="Nobody saves a builtin scene.")
    watch = Watch(Path(scene))
    while True:
        # An error is said, and the next save may mend it.
        with noted() as files:
            try:
                work()
            except AirlightError as error:
                say(f"error: {error}")
        # Materials and textures of its models are among what was read.
        watch.follow(files.stamps)
        click.echo(f"watching {scene}; Ctrl-C ends it", err=True)
        while not watch.changed():
            time.sleep(INTERVAL_S / 2.0)
