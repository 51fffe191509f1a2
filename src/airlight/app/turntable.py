"""`airlight turntable`: a model turns once around, into a video or frames."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from .options import (
    Number,
    adapter_option,
    ground_option,
    model_options,
    settings_option,
    size_option,
    sun_option,
)
from .scene_argument import load_scene, reads
from .sequence.cli import check_sequence, make_sequence
from .sequence.plan import FORMATS, Plan
from .sequence.video import VIDEO_SUFFIXES

if TYPE_CHECKING:
    from ..scene import Scene


@click.command("turntable")
@click.argument("scene")
@click.option(
    "-o",
    "--output",
    required=True,
    type=click.Path(path_type=Path),
    metavar="DIR|FILE.mp4",
    help="A folder for frames, or a video.",
)
@click.option("--seconds", type=Number(0.1, 3600), default=6.0, show_default=True, help="A turn.")
@click.option("--fps", type=Number(1e-3, 1e4), default=24.0, show_default=True, help="Per second.")
@click.option("-t", "--technique", default="auto", show_default=True, help="As for render.")
@size_option("1280x720")
@click.option(
    "--samples",
    type=click.IntRange(1, 4096),
    default=4,
    show_default=True,
    help="Jittered samples per pixel.",
)
@settings_option()
@model_options()
@sun_option()
@ground_option()
@adapter_option()
@click.option("--resume", is_flag=True, help="Go on where a run was broken off.")
@click.option("-q", "--quiet", is_flag=True, help="No progress.")
def command(scene: str, output: Path, **options: Any) -> None:
    """Go once around SCENE, from its own camera's height and distance.

    \b
    airlight turntable model.glb -o spin.mp4
    airlight turntable model.glb -o spin/ --size 480x270 --seconds 2 --sun 30,120

    The camera moves, sun and model stand still, so that nothing is solved twice; within walls it
    turns on the spot. The exposure is that of the first frame.
    """
    is_video = output.suffix.lower() in VIDEO_SUFFIXES
    reads(scene)
    check_sequence(output, {**options, "kind": None, "farm": None, "layers": False})
    loaded = around(load_scene(scene, options["model"]), options["seconds"], options["fps"])
    plan = Plan(
        technique=options["technique"],
        size=options["size"],
        start_s=0.0,
        fps=options["fps"],
        first=0,
        last=max(0, round(options["seconds"] * options["fps"]) - 1),
        settings=options["settings"],
        samples=options["samples"],
        adapter=options["adapter"],
        ending=FORMATS["png"],
    )
    make_sequence(plan, loaded, output, {**options, "farm": None, "keep_frames": not is_video})


def around(scene: Scene, seconds: float, fps: float) -> Scene:
    """The scene with an animation of its own: its camera goes once around what it looks at.

    Within walls it turns on the spot.
    """
    from ..scene.animation import Animation
    from ..scene.animation.tracks import OrbitTrack
    from ..scene.io.ground import without_ground
    from .view.free_space import FreeSpace

    camera = scene.camera
    eye = np.array(camera.position)
    pivot = None
    if not FreeSpace(scene).is_enclosed(eye):
        # Where the view is nearest to the middle: a file's camera may have its target anywhere.
        low, high = without_ground(scene).bounds
        look = np.subtract(camera.target, eye)
        look /= np.linalg.norm(look)
        ahead = float(look @ ((low + high) / 2.0 - eye))
        x, y, z = (eye + look * ahead if ahead > 0.0 else (low + high) / 2.0).tolist()
        pivot = (x, y, z)
    track = OrbitTrack(camera, seconds, pivot)
    return replace(scene, animation=Animation((track,), end_s=seconds, fps=fps))
