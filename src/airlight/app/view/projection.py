"""Between the scene and the image on the screen: points to pixels, pixels to rays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...maths.transforms import F64
from ...scene.camera import Camera, axes


@dataclass(frozen=True, eq=False)
class Projection:
    """Of `camera` onto an image of `size`, logical pixels, from the upper left."""

    camera: Camera
    size: tuple[float, float]

    @property
    def _focal_px(self) -> float:
        return self.size[1] / 2.0 / float(np.tan(np.radians(self.camera.fov_y_deg) / 2.0))

    def pixel(self, point: F64) -> F64 | None:
        """(x, y) of a point, metres; None behind the eye."""
        return self.towards(np.subtract(point, self.camera.position))

    def towards(self, direction: F64) -> F64 | None:
        """(x, y) of what is infinitely far in a direction; None behind the eye."""
        right, up, forward = axes(self.camera)
        depth = float(direction @ forward)
        if depth <= 1e-9 * float(np.linalg.norm(direction)):
            return None
        x, y = float(direction @ right) / depth, float(direction @ up) / depth
        width, height = self.size
        return np.array([width / 2.0 + self._focal_px * x, height / 2.0 - self._focal_px * y])

    def ray(self, x: float, y: float) -> F64:
        """The unit vector from the eye through a pixel."""
        right, up, forward = axes(self.camera)
        across, down = x - self.size[0] / 2.0, y - self.size[1] / 2.0
        # The image plane lies at the focal length, in pixels.
        direction = forward + (right * across - up * down) / self._focal_px
        return np.asarray(direction / np.linalg.norm(direction))

    def pixel_m(self, point: F64) -> float:
        """How many metres a pixel is at a point's depth."""
        _, _, forward = axes(self.camera)
        depth = float(np.subtract(point, self.camera.position) @ forward)
        return max(depth, 1e-9) / self._focal_px

    def on_plane(self, x: float, y: float, point: F64, normal: F64) -> F64 | None:
        """Where the ray through a pixel meets the plane through `point`; None where it does not."""
        ray = self.ray(x, y)
        slope = float(ray @ normal)
        if abs(slope) < 1e-6:
            return None
        # In front of the eye alone.
        distance = float(np.subtract(point, self.camera.position) @ normal) / slope
        return np.asarray(np.add(self.camera.position, distance * ray)) if distance > 0.0 else None

    def along(self, x: float, y: float, point: F64, axis: F64) -> float | None:
        """How far along `axis` from `point` is what comes nearest to the ray through a pixel."""
        ray = self.ray(x, y)
        cosine = float(ray @ axis)
        if 1.0 - cosine * cosine < 1e-4:  # the axis points at the eye
            return None
        # The points nearest to each other of two lines.
        away = np.subtract(point, self.camera.position)
        return float((cosine * (ray @ away) - axis @ away) / (1.0 - cosine * cosine))
