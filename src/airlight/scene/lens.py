"""A thin lens and a shutter by samples: where on the lens each one looks from, and when."""

from __future__ import annotations

import numpy as np

from ..maths.sampling import lens_points
from .camera import Camera, axes
from .placing import shifted
from .scene import Scene

STILL_SAMPLES, AIR_SAMPLES, LENS_SAMPLES = 12, 8, 64
"""Of stills: of surfaces, of media alone, and of what is a mean over a lens or a time."""


def has_moments(scene: Scene) -> bool:
    """Whether something may move while the camera's shutter is open."""
    return scene.animation is not None and scene.camera.shutter_s > 0.0


def shutter_time(scene: Scene, time_s: float | None) -> float | None:
    """When the shutter opens: as asked, or where it stays open from the animation's start on."""
    if time_s is None and scene.animation is not None and has_moments(scene):
        return scene.animation.start_s
    return time_s


def still_samples(scene: Scene) -> int:
    """Samples of a still: many where it is a mean over a lens or a time."""
    if has_moments(scene) or scene.camera.aperture_m > 0.0:
        return LENS_SAMPLES
    return STILL_SAMPLES if scene.meshes else AIR_SAMPLES


def through_lens(
    camera: Camera, jitter_px: tuple[float, float], sample: int, height_px: int
) -> tuple[Camera, tuple[float, float]]:
    """The pinhole camera of one sample of a lens, and the jitter of its image, pixels.

    The eye moves on the lens, the image as much against it as keeps the plane in focus where it
    was, so that what lies in it is sharp and nothing else is. Source: Haeberli1990, section 4.
    """
    if camera.aperture_m <= 0.0:
        return camera, jitter_px
    # A point of the lens, and the pinhole camera there.
    focus = camera.focus_m
    if focus is None:
        focus = float(np.linalg.norm(np.subtract(camera.target, camera.position)))
    # One point of the lens for each sample, in metres across the view.
    x, y = lens_points(sample) * (camera.aperture_m / 2.0)
    right, up, _ = axes(camera)
    moved = shifted(camera, x * right + y * up)
    # The plane in focus stays where it is on the image.
    px_per_m = height_px / (2.0 * focus * np.tan(np.radians(camera.fov_y_deg) / 2.0))
    return moved, (jitter_px[0] + x * px_per_m, jitter_px[1] - y * px_per_m)
