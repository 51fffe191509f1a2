"""One camera's image: its matrices and the textures that passes write."""

from __future__ import annotations

import numpy as np

from ..gpu.device import Gpu
from ..maths.transforms import (
    F64,
    clip_from_view_infinite,
    jittered,
    view_from_world,
)
from ..scene.camera import Camera
from ..surface.gbuffer import GBuffer
from .lighting import RadianceLayers
from .occlusion import OcclusionLayers

_NEAR_M = 0.01 * 2.0**-10
"""From the eye to the near plane, where the camera's target is a metre away or more; in proportion
where it is nearer. Reversed depth in float32 is as exact for any near plane."""


class View:
    """G-buffer and radiance of one image; `aim` sets the camera before each."""

    def __init__(self, gpu: Gpu, size: tuple[int, int], gbuffer: type[GBuffer] = GBuffer) -> None:
        """`gbuffer`: what draws its surfaces."""
        self.size = size
        self.gbuffer = gbuffer(gpu, size)
        self._sized = gpu.scope()
        self._make_layers()
        self.near_m = _NEAR_M
        """From the eye to the near plane: depth is `near_m` over the distance along the view."""
        self.clip_from_world: F64 = np.eye(4)
        self.world_from_clip: F64 = np.eye(4)
        self.eye: tuple[float, float, float] = (0.0, 0.0, 0.0)
        self.sample, self.jitter, self.jitters = 0, 0, 1
        self.is_still = False
        """Whether its image is one of several samples, not a frame alone."""
        self.may_gather = True
        """Whether its indirect light may be gathered; a quick image has the lattices' alone."""
        self.camera = Camera()
        self.metered_stops = 0.0
        """The exposure where the camera leaves it to the image: of unlit surfaces."""
        self.jitter_px = (0.0, 0.0)
        self._aimed: tuple[Camera, tuple[float, float], tuple[int, int]] | None = None

    def _make_layers(self) -> None:
        self.layers = RadianceLayers(self._sized, self.size)
        self.occlusion = OcclusionLayers(self._sized, self.size)

    def aim(
        self,
        camera: Camera,
        jitter_px: tuple[float, float] = (0.0, 0.0),
        sample: int = 0,
        jitter: tuple[int, int] = (0, 1),
    ) -> None:
        """Look through `camera`, the image moved by `jitter_px`; it is the still's `sample`.

        `jitter`: which of its images it is, and of how many; they differ by `jitter_px` alone.
        """
        self.sample, self.camera, (self.jitter, self.jitters) = sample, camera, jitter
        # Unlit surfaces are as bright as brings them out unchanged at this exposure.
        stops = self.metered_stops if camera.exposure_stops is None else camera.exposure_stops
        self.gbuffer.unlit_radiance = 2.0**-stops
        aim = (camera, jitter_px, self.size)
        if aim == self._aimed:
            return
        self._aimed, self.jitter_px = aim, jitter_px
        # The projection, moved by the jitter; depth is reversed, without a far plane.
        look = np.subtract(camera.target, camera.position)
        view = view_from_world(camera.position, look, camera.up)
        aspect = self.size[0] / self.size[1]
        self.near_m = _NEAR_M * min(1.0, float(np.linalg.norm(look)))
        clip = clip_from_view_infinite(np.radians(camera.fov_y_deg), aspect, self.near_m)
        self.clip_from_world = jittered(clip, jitter_px, self.size) @ view
        self.world_from_clip = np.asarray(np.linalg.inv(self.clip_from_world), np.float64)
        self.eye = camera.position

    @property
    def number(self) -> int:
        """Of its image among all that a still is the mean of."""
        return self.sample * self.jitters + self.jitter

    def follow(self, other: View) -> None:
        """Look where `other`, of the same size, looks."""
        # The same camera and jitter, so that pixels of both views match.
        self.sample, self.camera, self.is_still = other.sample, other.camera, other.is_still
        self.jitter, self.jitters = other.jitter, other.jitters
        self._aimed, self.jitter_px, self.eye = other._aimed, other.jitter_px, other.eye
        self.near_m = other.near_m
        self.gbuffer.unlit_radiance = other.gbuffer.unlit_radiance
        self.clip_from_world = other.clip_from_world
        self.world_from_clip = other.world_from_clip

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on."""
        self.size = size
        self.gbuffer.resize(size)
        # Layers of the former size are given back together.
        self._sized.release()
        self._make_layers()
