"""`airlight turntable`: a model turns once around, into a video or frames."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from ..maths.latlong import turned_about_y
from .options import Number, display_doubts, display_options
from .scene_argument import load_scene, reads, warn
from .scene_options import with_exposure
from .sequence.cli import (
    FRAME_OPTIONS,
    check_sequence,
    frame_kind_options,
    make_sequence,
    plan_of,
    shown_by,
)
from .sequence.plan import FORMATS
from .sequence.video import VIDEO_SUFFIXES

if TYPE_CHECKING:
    from ..maths.transforms import F64
    from ..scene import Camera, Scene
    from ..scene.animation import Animation

_VIEWS = 72
"""Sides that are looked at: between two of them less than .1 % of a radius is not seen."""


@click.command("turntable")
@FRAME_OPTIONS
@click.option("--seconds", type=Number(0.1, 3600), default=6.0, show_default=True, help="A turn.")
@click.option("--fps", type=Number(1e-3, 1e4), default=24.0, show_default=True, help="Per second.")
@click.option("--play", is_flag=True, help="What moves in the scene plays, from 0 s on.")
@display_options()
@frame_kind_options()
def command(scene: str, output: Path, **options: Any) -> None:
    """Go once around SCENE, from its own camera's height and distance.

    \b
    airlight turntable model.glb -o spin.mp4
    airlight turntable model.glb -o spin/ --size 480x270 --seconds 2 --sun 30,120

    The camera moves, the light and the model are static, so that nothing is solved twice, unless
    they --play; within walls it turns on the spot. Where the image chooses the exposure it is that
    of the first frame.
    """
    is_video = output.suffix.lower() in VIDEO_SUFFIXES
    reads(scene)
    # What a sequence could refuse is refused before the scene is loaded.
    check_sequence(output, {**options, "farm": None})
    read = with_exposure(load_scene(scene, options["model"]), options["exposure"])
    warn(display_doubts(FORMATS[options["kind"] or "png"], options))
    if any(_playing(read.animation)) and not options["play"]:
        warn(("what moves in the scene is static: --play lets it move",))
    loaded = around(read, options["seconds"], options["fps"], plays=options["play"])
    # The last frame stands one step before the first, so that a video loops.
    last = max(0, round(options["seconds"] * options["fps"]) - 1)
    frames = {"start_s": 0.0, "fps": options["fps"], "first": 0, "last": last}
    plan = plan_of(loaded, options, **frames, **shown_by(options))
    keeps = options["keep_frames"] or not is_video
    make_sequence(plan, loaded, output, {**options, "farm": None, "keep_frames": keeps})


def around(scene: Scene, seconds: float, fps: float, *, plays: bool = False) -> Scene:
    """The scene with an animation of its own: its camera goes once around what it looks at.

    What moves beside the camera `plays`, or is static. Within walls it turns on the spot. Where it
    shows all of the model it starts as far back as keeps all of it in the image on every side.
    """
    from ..scene.animation import Animation
    from ..scene.animation.tracks import OrbitTrack
    from ..scene.io.dense_part import air_beside
    from ..scene.io.ground import without_ground
    from ..scene.io.outline import outline
    from ..scene.placing import shifted
    from .view.free_space import FreeSpace

    camera = scene.camera
    eye = np.array(camera.position)
    pivot = None
    # In the open the camera goes around; within walls it would go through them.
    if not FreeSpace(scene).is_enclosed(eye):
        # Where the view is nearest to the middle: a file's camera may have its target anywhere.
        low, high = without_ground(scene).bounds
        look = np.subtract(camera.target, eye)
        look /= np.linalg.norm(look)
        ahead = float(look @ ((low + high) / 2.0 - eye))
        # Where the middle lies behind the eye it is the pivot itself.
        x, y, z = (eye + look * ahead if ahead > 0.0 else (low + high) / 2.0).tolist()
        pivot = (x, y, z)
        points = outline(without_ground(scene))
        points = np.concatenate([points, air_beside(scene, points)])
        back = look * _step_back(camera, points, np.array(pivot))
        camera = shifted(camera, -back)
    track = OrbitTrack(camera, seconds, pivot)
    tracks = (*(_playing(scene.animation) if plays else ()), track)
    return replace(scene, camera=camera, animation=Animation(tracks, end_s=seconds, fps=fps))


def _playing(animation: Animation | None) -> Iterator[Any]:
    """The tracks of all that moves beside the camera."""
    from ..scene.animation.rig import Rig
    from ..scene.animation.tracks import CameraTrack

    for track in animation.tracks if animation else ():
        if isinstance(track, Rig):
            if track.parts or track.lights:
                yield replace(track, camera=None)
        elif not isinstance(track, CameraTrack):
            yield track


def _step_back(camera: Camera, points: F64, pivot: F64) -> float:
    """How far back, metres, the eye has to be for all points (N, 3) to stay in a 4:3 image while
    they turn about the vertical through `pivot`; 0 where the image does not show all of them."""
    from ..scene.camera import axes

    right, up, forward = axes(camera)
    half = np.tan(np.radians(camera.fov_y_deg) / 2.0)
    # Turned points before a camera that rests are what an orbiting one sees.
    needed = []
    for angle in np.linspace(0.0, 2.0 * np.pi, _VIEWS, endpoint=False):
        offset = turned_about_y(points - pivot, np.degrees(angle)) + pivot - camera.position
        x, y = offset @ right, offset @ up
        outside = np.maximum(np.abs(x) * 0.75, np.abs(y)) / half - offset @ forward
        needed.append(float(outside.max(initial=-np.inf)))
    return max(needed) if needed[0] <= 0.0 < max(needed) else 0.0
