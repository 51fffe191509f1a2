"""Virtual point lights: what surfaces reflect into a medium, once (Elek2014 section 6).

Texels of reflective shadow maps are taken by what about arrives of their light in the medium, from
a running sum of it: one of each of `count` equal parts, so that the same scene always has the same
ones, and a small change moves them little. All of it happens on the device. A virtual light stands
for a piece of surface: a cosine lobe whose fall-off ends where the piece is as near as it is wide,
instead of the clamping that Elek2014 takes from instant radiosity.
Elek2014 gives each a radial grid, as `virtual_grids` does here for the schemes split and paper, and
for delta-beam on request. differs: there they are more of its beams by default, which costs less
and errs less.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, f32, mat4x4f, u32, vec3f
from ...gpu.memory import Buffer
from ...gpu.slots import storage, texture, uniform
from ...lattice.blockers import Blockers
from ...lattice.placement import LatticeParams, Placement
from ...surface.light_views import LightViewData
from ...surface.reflective import ReflectiveShadowMaps
from ..light.ordinates import Kind, OrdinateData
from ..medium.placement import MediumParams, MediumPlacement

TILE = 16
"""Texels along a side of what is summed at once."""
_SCAN = 256

_CONSTANTS = f"const TILE = {TILE}u;\nconst PI = 3.14159265;\n"


@dataclass(eq=False)
class Reflected:
    """What virtual lights are taken from: maps, and what stands between them and media."""

    maps: tuple[ReflectiveShadowMaps, ...]
    blockers: Blockers
    placement: Placement
    count: int
    version: int = 0


class VirtualParams(Struct):
    """A set of maps, the medium, and where virtual lights are written."""

    medium_from_world = mat4x4f()
    centre = vec3f("m, of the medium in the world")
    radius = f32("m")
    resolution = u32("texels")
    side = u32("tiles along a map's side")
    layers = u32()
    first_tile = u32("of these maps")
    all_tiles = u32("of all maps")
    count = u32("virtual lights")
    first_row = u32("of the ordinates")
    scale = f32("of the ordinates' irradiance, W m^-2")
    kind = f32("their Kind")


class ScanParams(Struct):
    """How many tiles there are."""

    count = u32()


class SightParams(Struct):
    """Which rows are virtual lights."""

    world_from_medium = mat4x4f()
    count = u32()
    first_row = u32()


_maps = (
    uniform("params", VirtualParams),
    storage("views", LightViewData),
    texture("depth", "2d-array", "depth"),
    texture("normal", "2d-array", "unfilterable-float"),
    texture("flux", "2d-array", "unfilterable-float"),
)


class _Tiles(ComputePass):
    slots = (*_maps, storage("tiles", "f32", "read_write"))
    workgroup = (64, 1, 1)
    file = "tiles.wgsl"


class _Scan(ComputePass):
    slots = (uniform("params", ScanParams), storage("tiles", "f32", "read_write"))
    workgroup = (_SCAN, 1, 1)
    file = "scan.wgsl"


class _Pick(ComputePass):
    slots = (
        *_maps,
        storage("tiles", "f32"),
        uniform("lattice", LatticeParams),
        texture("lattice_walls", "3d"),
        storage("ordinates", OrdinateData, "read_write"),
        storage("places", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "pick.wgsl"


class _Sight(ComputePass):
    slots = (
        uniform("params", MediumParams),
        uniform("sight", SightParams),
        uniform("lattice", LatticeParams),
        *(texture(f"lattice_{name}", "3d") for name in ("visibility_a", "visibility_b", "walls")),
        storage("places", "vec4f"),
        storage("reach", "u32"),
        storage("passed", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "visibility.wgsl"


class VirtualLights:
    """Writes the last rows of a medium's ordinates, and what surfaces keep from it of them."""

    def __init__(self, gpu: Gpu, reflected: Reflected, *, are_hopping: bool) -> None:
        """`are_hopping`: whether each has a grid, or is a beam of the medium."""
        self._of, self._kind = reflected, Kind.HOPS_ON if are_hopping else Kind.FROM_SURFACE
        self._tiles_of = [_side(maps) ** 2 * maps.layers for maps in reflected.maps]
        self._tiles = Buffer(gpu, "tiles of maps", 4 * max(1, sum(self._tiles_of)))
        self._places = Buffer(gpu, "virtual lights in cells", 16 * reflected.count)
        self._sum, self._pick = _Tiles(gpu, generated=_CONSTANTS), _Pick(gpu, generated=_CONSTANTS)
        self._scan, self._sight = _Scan(gpu), _Sight(gpu)
        self._first_row = 0

    def encode(
        self,
        commands: Commands,
        placement: MediumPlacement,
        ordinates: Buffer,
        first_row: int,
        scale: float,
    ) -> None:
        """Choose: rows `first_row` and on of `ordinates`, in units of `scale`."""
        self._first_row = first_row
        found = [p for p in self._params(placement, first_row, scale) if p[0].layers]
        if not found:
            return
        for maps, params in found:
            self._sum.dispatch(
                commands,
                (_side(maps) ** 2 * maps.layers,),
                params=params,
                **_bound(maps),
                tiles=self._tiles,
            )
        scan = ScanParams(count=sum(self._tiles_of))
        self._scan.dispatch(commands, (1,), params=scan, tiles=self._tiles)
        for maps, params in found:
            self._pick.dispatch(
                commands,
                (self._of.count,),
                params=params,
                **_bound(maps),
                tiles=self._tiles,
                lattice=self._of.placement.params(),
                lattice_walls=self._of.blockers.walls,
                ordinates=ordinates,
                places=self._places,
            )

    def encode_sight(
        self,
        commands: Commands,
        params: MediumParams,
        placement: MediumPlacement,
        *,
        reach: Buffer,
        passed: Buffer,
    ) -> None:
        """Shares of their light, 0..1, into the second half of `passed`."""
        sight = SightParams(
            world_from_medium=placement.world_from_medium,
            count=self._of.count,
            first_row=self._first_row,
        )
        self._sight.dispatch(
            commands,
            (placement.cells, self._of.count),
            params=params,
            sight=sight,
            lattice=self._of.placement.params(),
            **self._of.blockers.bound,
            places=self._places,
            reach=reach,
            passed=passed,
        )

    def _params(
        self, placement: MediumPlacement, first_row: int, scale: float
    ) -> list[tuple[ReflectiveShadowMaps, VirtualParams]]:
        to_world = placement.world_from_medium
        half = 0.5 * placement.extent
        firsts = np.cumsum([0, *self._tiles_of])
        return [
            (
                maps,
                VirtualParams(
                    medium_from_world=np.linalg.inv(to_world),
                    centre=to_world[:3, :3] @ half + to_world[:3, 3],
                    radius=float(np.linalg.norm(half)),
                    resolution=maps.resolution,
                    side=_side(maps),
                    layers=maps.layers,
                    first_tile=int(firsts[k]),
                    all_tiles=int(firsts[-1]),
                    count=self._of.count,
                    first_row=first_row,
                    scale=scale,
                    kind=self._kind,
                ),
            )
            for k, maps in enumerate(self._of.maps)
        ]


def _side(maps: ReflectiveShadowMaps) -> int:
    return -(-maps.resolution // TILE)


def _bound(maps: ReflectiveShadowMaps) -> dict[str, object]:
    return {"views": maps.views, "depth": maps.depth, "normal": maps.normal, "flux": maps.flux}
