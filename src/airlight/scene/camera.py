"""A camera: a pinhole, or a lens with a shutter."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import SceneError
from . import checks
from .checks import F64, Vec3

USUAL_PX = (1280, 720)
MOST_ASPECT = 100.0


@dataclass(frozen=True)
class Camera:
    """A camera in a right-handed world, +Y up, metres.

    `position` looks at `target`; `fov_y_deg` is the full vertical field of view.
    `exposure_stops` scales the displayed image by 2**stops (None: from the image itself);
    radiance is not touched. `aperture_m` is the diameter of its lens, 0 for a pinhole; what lies
    `focus_m` ahead along the view is sharp (None: what lies at the target's distance). `shutter_s`:
    how long the shutter is open from a frame's time on, while things move. `film_px`: (width,
    height) of its images where nobody asks for others; without it they have 1280x720.
    Raises SceneError for a camera that looks nowhere.
    """

    position: Vec3 = (0.0, 1.0, 5.0)
    target: Vec3 = (0.0, 1.0, 0.0)
    up: Vec3 = (0.0, 1.0, 0.0)
    fov_y_deg: float = 50.0
    exposure_stops: float | None = 0.0
    aperture_m: float = 0.0
    focus_m: float | None = None
    shutter_s: float = 0.0
    film_px: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        # Each field is checked, and kept as plain numbers.
        put(self, "position", checks.vec3(self.position, "camera position"))
        put(self, "target", checks.vec3(self.target, "camera target"))
        put(self, "up", checks.unit_vec3(self.up, "camera up"))
        put(self, "fov_y_deg", checks.number(self.fov_y_deg, "fov_y_deg", low=0.1, high=179.0))
        if self.exposure_stops is not None:
            put(self, "exposure_stops", checks.stops(self.exposure_stops, "exposure_stops"))
        put(self, "aperture_m", checks.number(self.aperture_m, "aperture_m", low=0.0, high=1e6))
        put(self, "shutter_s", checks.number(self.shutter_s, "shutter_s", low=0.0, high=1e6))
        if self.focus_m is not None:
            put(self, "focus_m", checks.number(self.focus_m, "focus_m", low=1e-6, high=1e9))
        if self.film_px is not None:
            put(self, "film_px", checks.size_px(self.film_px, "film_px"))
        # The view needs a direction, and an up that is not along it.
        look = np.subtract(self.target, self.position)
        if not np.any(look):
            raise SceneError("camera position and target are the same point")
        if np.linalg.norm(np.cross(look, self.up)) < 1e-6 * np.linalg.norm(look):
            # Looking straight along `up`: any other up does.
            put(self, "up", (0.0, 0.0, -1.0) if abs(self.up[1]) > 0.9 else (0.0, 1.0, 0.0))

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of its images where nobody asks for others, pixels."""
        return self.film_px or USUAL_PX

    def size_near(self, usual: tuple[int, int]) -> tuple[int, int]:
        """(width, height), pixels: `usual`, or of its area and the shape of the film, if any."""
        if self.film_px is None:
            return usual
        return film_of(self.film_px[0] / self.film_px[1], usual) or usual

    def size_within(self, usual: tuple[int, int]) -> tuple[int, int]:
        """`film_px` where it has no more pixels than `usual`; else `size_near`."""
        film = self.film_px
        if film is not None and film[0] * film[1] <= usual[0] * usual[1]:
            return film
        return self.size_near(usual)


def film_of(aspect: float, usual: tuple[int, int] = USUAL_PX) -> tuple[int, int] | None:
    """The size in pixels, even on both sides, of an image of usual area and `aspect`: its width by
    its height. None for one that no image has."""
    if not MOST_ASPECT > aspect > 1.0 / MOST_ASPECT:
        return None
    # The usual area in the shape that is asked for.
    width = (usual[0] * usual[1] * aspect) ** 0.5
    height = width / aspect
    return (2 * round(width / 2.0), 2 * round(height / 2.0))


def axes(camera: Camera) -> tuple[F64, F64, F64]:
    """(right, up, forward) of the image, unit vectors."""
    forward = np.subtract(camera.target, camera.position)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, camera.up)
    right = right / np.linalg.norm(right)
    return right, np.cross(right, forward), forward


def view_directions(camera: Camera, columns: int, rows: int, aspect: float = 16 / 9) -> F64:
    """Unit directions (rows * columns, 3) through the middles of a camera's coarse pixels."""
    right, up, forward = axes(camera)
    # The plane one unit ahead, in the middles of pixels, so that no ray lies on the border of the
    # view.
    half = math.tan(math.radians(camera.fov_y_deg) / 2.0)
    x = (2.0 * (np.arange(columns) + 0.5) / columns - 1.0) * half * aspect
    y = (1.0 - 2.0 * (np.arange(rows) + 0.5) / rows) * half
    px, py = (p.ravel()[:, None] for p in np.meshgrid(x, y))
    rays = forward + px * right + py * up
    unit: F64 = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return unit
