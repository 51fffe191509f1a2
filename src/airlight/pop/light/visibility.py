"""Shadows of surfaces in a medium: the share of each ordinate that reaches every cell past them.

Directional and local lights ask their shadow maps. An ordinate of the sky asks the depth maps of
those of the sky's directional lights that lie in its part of the sphere. Elek2014 section 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.layout import Struct, f32, u32
from ...gpu.memory import Buffer
from ...gpu.rows import table
from ...gpu.slots import storage, texture, uniform
from ...lattice.blockers import Blockers
from ...lighting.lights import Lights
from ...lighting.shadow_rays import SceneRays
from ...lighting.sky import Sky
from ...maths.ordinates import Ordinates
from ...maths.transforms import F64
from ...scene.lights import DirectionalLight, Light
from ...surface.geometry import GpuScene
from ...surface.light_table import SHADOWED_LIGHT_SLOTS
from ...surface.light_views import LightViewData
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams
from ..virtual.reflected import ReflectedLights


@dataclass(frozen=True, eq=False)
class Surfaces:
    """The surfaces around media: their shadow maps, and what they reflect.

    `rays`: what rays meet of them. `blockers`: cells between media, and how much surfaces reflect.
    `reflected`: where virtual point lights are sampled from.
    """

    meshes: GpuScene
    lights: Lights
    sky: Sky
    rays: SceneRays
    blockers: Blockers
    reflected: ReflectedLights | None = None

    @property
    def version(self) -> tuple[int, ...]:
        """Another one whenever a map was redrawn."""
        own = self.meshes.version, self.lights.parallel.version, self.lights.local.version
        return own if self.reflected is None else (*own, self.reflected.version)

    @property
    def virtual_lights(self) -> int:
        """How many virtual point lights there are among the ordinates of a medium."""
        return 0 if self.reflected is None else self.reflected.count


class ShadowsData(Struct):
    """The shadow maps of one ordinate."""

    light = u32("its number in the scene from 1; 0 for the sky's")
    first = u32("of its sky views")
    count = u32("of its sky views; 0: nothing shades it")
    pad = u32()


class SkyViewData(Struct):
    """A directional light of the sky, as part of an ordinate."""

    layer = u32()
    weight = f32("share of its ordinate's light")


class Visibility(ComputePass):
    """Fills the second part of `Paths.passed`: shares of light, 0..1."""

    slots = (
        uniform("params", MediumParams),
        storage("shadows", ShadowsData),
        storage("sky_shares", SkyViewData),
        storage("reach", "u32"),
        *SHADOWED_LIGHT_SLOTS,
        table("sky_views", LightViewData),
        texture("sky_depth", "2d-array", "depth"),
        storage("passed", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)

    def __init__(self, medium: GridMedium, capacity: int) -> None:
        """For up to `capacity` ordinates of `medium`."""
        super().__init__(medium.gpu)
        self._medium = medium
        self._shadows = Buffer(medium.gpu, "shadows", ShadowsData.dtype.itemsize * capacity)
        self._shares = Buffer(medium.gpu, "sky shares", SkyViewData.dtype.itemsize)
        self._unshaded = 0

    def write(
        self, ordinates: Ordinates, lights: tuple[Light, ...], sky: Sky, unshaded: int = 0
    ) -> None:
        """Take the light of a frame; nothing shades the `unshaded` ordinates after it.

        `ordinates`: without local lights, those of directional lights first.
        """
        # Which maps each ordinate asks; the last ordinates ask none.
        rows, shares = shadow_rows(ordinates, lights, sky.lights if sky.maps.layers else [])
        rows = np.concatenate([rows, np.zeros(unshaded, rows.dtype)])
        self._unshaded = unshaded
        self._shadows.write(rows)
        # How many of the sky's lights the ordinates share varies with the sky.
        if shares.nbytes > self._shares.nbytes:
            self._shares.release()
            self._shares = Buffer(self._medium.gpu, "sky shares", shares.nbytes)
        self._shares.write(shares)

    def encode(
        self,
        commands: Commands,
        params: MediumParams,
        count: int,
        surfaces: Surfaces,
        passed: Buffer,
    ) -> None:
        """Fill shares of the first `count` ordinates but the unshaded, after their paths."""
        # The shares lie behind the column densities in `passed`.
        lights, maps = surfaces.lights, surfaces.sky.maps
        self.dispatch(
            commands,
            (self._medium.cells, max(1, count - self._unshaded)),
            params=params,
            shadows=self._shadows,
            sky_shares=self._shares,
            reach=self._medium.density.reach,
            lights=lights.table,
            parallel_views=lights.parallel.views,
            local_views=lights.local.views,
            sky_views=maps.views,
            parallel_shadows=lights.parallel.depth,
            local_shadows=lights.local.depth,
            sky_depth=maps.depth,
            shadow_compare=lights.parallel.sampler,
            passed=passed,
        )


def shadow_rows(
    ordinates: Ordinates, lights: tuple[Light, ...], sky: Sequence[DirectionalLight]
) -> tuple[NDArray[Any], NDArray[Any]]:
    """`ShadowsData` of the ordinates, then of local lights; and the sky's shares in their order.

    Every light of the sky belongs to the nearest ordinate; an ordinate without one takes the
    nearest.
    """
    # Directional and local lights have shadow maps of their own.
    distant = [i for i, light in enumerate(lights) if isinstance(light, DirectionalLight)]
    local = [i for i, light in enumerate(lights) if not isinstance(light, DirectionalLight)]
    of_sky = ordinates.direction[len(distant) :]
    rows = np.zeros(max(1, ordinates.count + len(local)), ShadowsData.dtype)
    rows["light"][: len(distant)] = np.array(distant, np.uint32) + 1
    rows["light"][ordinates.count : ordinates.count + len(local)] = np.array(local, np.uint32) + 1
    if not sky or not len(of_sky):
        return rows, np.zeros(1, SkyViewData.dtype)
    # Ordinates of the sky share those of its lights.
    directions = np.array([light.direction for light in sky])
    weights = np.array([light.irradiance for light in sky]).sum(axis=1)
    owner, layer, weight = _shared(of_sky, directions, weights)
    counts = np.bincount(owner, minlength=len(of_sky))
    part = rows[len(distant) : ordinates.count]
    # Each ordinate has a run of shares, whose weights add up to 1.
    part["count"] = counts
    part["first"] = np.cumsum(counts) - counts
    shares = np.zeros(len(layer), SkyViewData.dtype)
    shares["layer"] = layer
    shares["weight"] = weight / np.bincount(owner, weight, len(of_sky))[owner]
    return rows, shares


def _shared(
    of_sky: F64, directions: F64, weights: F64
) -> tuple[NDArray[np.intp], NDArray[np.intp], F64]:
    """(owner, layer, weight) of every share, sorted by owner."""
    # Each light of the sky shades the ordinate that is nearest to it.
    cosine = of_sky @ directions.T
    owner = np.argmax(cosine, axis=0)
    # An ordinate to which none is nearest asks the map of the light that is nearest to it.
    lonely = np.setdiff1d(np.arange(len(of_sky)), owner)
    layer = np.concatenate([np.arange(len(directions)), np.argmax(cosine[lonely], axis=1)])
    owner = np.concatenate([owner, lonely])
    # The shares of one ordinate lie beside each other.
    order = np.argsort(owner, kind="stable")
    # A dark light has a share, too: the shares of an ordinate are divided by their sum.
    weight = np.maximum(weights[layer], 1e-12 * max(float(weights.max()), 1e-30))
    return owner[order], layer[order], weight[order]
