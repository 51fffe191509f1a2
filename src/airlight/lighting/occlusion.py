"""Screen-space occlusion by surfaces that lattices do not resolve, and their radiance.

A lattice smooths light over a cell, so surfaces beside a sunlit strip would stay dark. For each
pixel, the lattice light from directions that near surfaces occlude is removed, and the radiance
that these surfaces send to the eye replaces it: each step that raises a horizon angle contributes
the radiance of its sample.

Horizon angles are searched in slices through the direction to the eye, and the cosine-weighted
visibility between them is exact (GTAO, Jimenez2016). Rotation and offset of the samples follow the
paper's 4 x 4 pattern, which the mean over 4 x 4 texels of similar depth removes.

differs: Jimenez2016 adds a temporal pattern; here an image depends on nothing but the scene.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.layout import Struct, f32, u32, vec2u, vec3f
from ..gpu.memory import Texture
from ..gpu.slots import texture, uniform
from ..lattice.placement import Placement
from ..maths.transforms import F64
from ..surface.gbuffer import GBuffer

SCALE = 2
"""Pixels along a texel's side: what is near is upsampled by depth. A frame's indirect light is .09
(`builtin:room`) and .11 (the atrium) from that of 8 slices of 16 steps at every pixel, where 3 of 6
at every pixel are .04 and .07; on an H100 those took 9.3 of a frame's 21 ms."""


class OcclusionParams(Struct):
    """Rays through pixels, from the eye and one metre deep, and the radius of the search."""

    corner = vec3f("m, through the image's upper left corner")
    depth_scale = f32("m^-1, inverse distance along the view axis per unit of depth")
    right = vec3f("m px^-1")
    radius = f32("m")
    down = vec3f("m px^-1")
    scale = u32("pixels along one side of a texel")
    size = vec2u("px")
    reduced = vec2u("px")
    growth = f32("how much farther to look per metre from the eye")
    largest = f32("m, but no farther")


class _ReducedSurfaces(FullscreenPass):
    slots = (
        uniform("params", OcclusionParams),
        texture("depth", "2d", "depth"),
        texture("normal", "2d", "unfilterable-float"),
        texture("lit", "2d", "unfilterable-float"),
    )
    targets = ("rgba32uint",)
    file = "occlusion_surfaces.wgsl"


class _HorizonSearch(FullscreenPass):
    slots = (*_ReducedSurfaces.slots, texture("surfaces", "2d", "uint"))
    targets = ("rgba32uint",)
    file = "occlusion.wgsl"


class _Blur(FullscreenPass):
    slots = (uniform("params", OcclusionParams), texture("sampled", "2d", "uint"))
    targets = ("rgba32uint",)
    file = "occlusion_blur.wgsl"


class OcclusionLayers:
    """Radiance and solid angle of near occluders per texel, see `near_field_texel.wgsl`.

    A texel is SCALE x SCALE pixels.
    """

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        """For an image of `size`, pixels."""
        self.size = size
        # The near field is found for blocks of pixels, and interpolated.
        reduced = (-(-size[0] // SCALE), -(-size[1] // SCALE))
        self.surfaces, self.sampled, self.near = (
            Texture(gpu, label, reduced, "rgba32uint", target=True, written=True)
            for label in ("surfaces", "sampled near field", "near field")
        )


@dataclass(frozen=True)
class SearchRadius:
    """The radius, m, within which surfaces occlude; where that is larger, `growth` times the
    distance to the eye, at most `largest`, m.
    """

    radius: float
    growth: float = 0.0
    largest: float = 0.0


def lattice_reach(wanted: float, placements: Sequence[Placement]) -> SearchRadius:
    """Where surfaces that lattices do not resolve occlude: within `wanted` cells.

    `placements`: of the lattices, the finest first.
    """
    # Near the eye the finest cells; from there on they grow with the distance, up to the coarsest.
    finest, coarsest = placements[0], placements[-1]
    return SearchRadius(
        wanted * finest.cell,
        growth=wanted * 2.0 / max(finest.count),
        largest=wanted * coarsest.cell,
    )


class Occlusion:
    """Depth and normals -> visibility of the near field, and its radiance."""

    def __init__(self, gpu: Gpu, *, has_light: bool = False) -> None:
        """`has_light`: occluders contribute the radiance that they show."""
        # How many samples there are depends on what they cost on this device.
        slices, steps = gpu.paths.occlusion_samples
        kind = {"HAS_LIGHT": float(has_light)}
        self._surfaces = _ReducedSurfaces(gpu, constants=kind)
        counts = {"SLICES": float(slices), "STEPS": float(steps)}
        self._horizons = _HorizonSearch(gpu, constants=counts | kind)
        self._blur = _Blur(gpu)

    def encode(
        self,
        commands: Commands,
        gbuffer: GBuffer,
        layers: OcclusionLayers,
        world_from_clip: F64,
        reach: SearchRadius,
        *,
        lit: Texture | None = None,
    ) -> None:
        """Fill `layers`; surfaces within `reach` occlude, fading out with distance.

        `lit`: radiance of surfaces towards the eye, W m^-2 sr^-1, per pixel.
        """
        # Surfaces at reduced size, horizons among them, then the mean over the pattern.
        params = occlusion_params(world_from_clip, layers, reach)
        inputs = {
            "params": params,
            "depth": gbuffer.depth,
            "normal": gbuffer.normal,
            "lit": lit or gbuffer.normal,
        }
        self._surfaces.draw(commands, (layers.surfaces,), **inputs)
        self._horizons.draw(commands, (layers.sampled,), surfaces=layers.surfaces, **inputs)
        self._blur.draw(commands, (layers.near,), params=params, sampled=layers.sampled)


def occlusion_params(
    world_from_clip: F64,
    layers: OcclusionLayers,
    reach: SearchRadius,
) -> OcclusionParams:
    """The image's rays from its matrix (reversed infinite depth), and how far to look."""
    # Directions through pixels are linear in their place: one at the corner and two steps.
    width, height = layers.size
    corner = (world_from_clip @ (-1.0, 1.0, 0.0, 1.0))[:3]
    return OcclusionParams(
        corner=corner,
        right=world_from_clip[:3, 0] * (2.0 / width),
        down=world_from_clip[:3, 1] * (-2.0 / height),
        depth_scale=float(world_from_clip[3, 2]),
        radius=reach.radius,
        scale=SCALE,
        size=layers.size,
        reduced=np.array(layers.near.size[:2]),
        growth=reach.growth,
        largest=max(reach.largest, reach.radius),
    )
