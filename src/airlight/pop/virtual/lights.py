"""Virtual point lights: what surfaces reflect into a medium, once (Elek2014 section 6).

Texels of reflective shadow maps are sampled by about what arrives of their light in the medium: one
at each of `count` equal steps of its running sum, so that the same scene always has the same
samples, and a small change moves them little. The device does all of it. A virtual point light
stands for a piece of surface: a cosine lobe whose fall-off ends where the piece is as near as it is
wide, instead of the clamping that Elek2014 takes from instant radiosity. Elek2014 gives each a
radial grid, as `virtual.grids` does for the schemes split and paper, and for delta-beam on request.
differs: delta-beam makes them beams by default, which costs less and errs less.
"""

from __future__ import annotations

import numpy as np

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.layout import Struct, f32, mat4x4f, u32, vec3f
from ...gpu.memory import Buffer
from ...gpu.rows import table
from ...gpu.slots import storage, texture, uniform
from ...lattice.blockers import BLOCKER_SLOTS
from ...lattice.placement import LatticeParams
from ...surface.light_views import LightViewData
from ...surface.reflective import ReflectiveShadowMaps
from ..light.table import Kind, OrdinateData, OrdinateTable
from ..medium.grid_medium import GridMedium
from ..medium.placement import MediumParams
from .reflected import ReflectedLights

TILE = 16
"""Texels along a side of what is summed at once."""
# Invocations that scan the sums of tiles.
_SCAN_GROUP = 256

_CONSTANTS = f"const TILE = {TILE}u;\nconst PI = 3.14159265;\n"


class VirtualParams(Struct):
    """A set of maps, the medium, and where virtual point lights are written."""

    medium_from_world = mat4x4f()
    centre = vec3f("m, of the medium in the world")
    radius = f32("m")
    resolution = u32("texels")
    side = u32("tiles along a map's side")
    layers = u32()
    first_tile = u32("of these maps")
    all_tiles = u32("of all maps")
    count = u32("virtual point lights")
    first_row = u32("of the ordinates")
    scale = f32("of the ordinates' irradiance, W m^-2")
    kind = f32("their Kind")


class ScanParams(Struct):
    """How many tiles there are."""

    count = u32()


class VirtualVisibilityParams(Struct):
    """Which rows are virtual point lights."""

    count = u32()
    first_row = u32()


# The reflective shadow maps, which are summed by tiles and drawn from.
_maps = (
    uniform("params", VirtualParams),
    table("views", LightViewData),
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
    workgroup = (_SCAN_GROUP, 1, 1)
    file = "scan.wgsl"


class _Pick(ComputePass):
    slots = (
        *_maps,
        storage("tiles", "f32"),
        uniform("lattice", LatticeParams),
        texture("lattice_walls", "3d"),
        storage("ordinates", OrdinateData, "read_write"),
        storage("light_cells", "vec4f", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "pick.wgsl"


class _Visibility(ComputePass):
    slots = (
        uniform("params", MediumParams),
        uniform("virtual_lights", VirtualVisibilityParams),
        uniform("lattice", LatticeParams),
        *BLOCKER_SLOTS,
        storage("light_cells", "vec4f"),
        storage("reach", "u32"),
        storage("passed", "f32", "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "visibility.wgsl"


class VirtualLights:
    """Writes rows of a medium's ordinates, and their visibility past surfaces."""

    def __init__(self, medium: GridMedium, reflected: ReflectedLights, *, in_grids: bool) -> None:
        """`in_grids`: each propagates in a grid of its own, else it is a beam of the medium."""
        gpu = medium.gpu
        self._medium, self._from = medium, reflected
        self._kind = Kind.VIRTUAL_GRID if in_grids else Kind.VIRTUAL
        # The running sum over tiles finds a light's tile, a sum over the tile's texels the light.
        self._tiles_of = [_side(maps) ** 2 * maps.layers for maps in reflected.maps]
        self._tiles = Buffer(gpu, "tiles of maps", 4 * max(1, sum(self._tiles_of)))
        # Lattice coordinates of each virtual point light.
        self._light_cells = Buffer(gpu, "virtual lights in cells", 16 * reflected.count)
        self._sum, self._pick = _Tiles(gpu, generated=_CONSTANTS), _Pick(gpu, generated=_CONSTANTS)
        self._scan, self._visibility = _Scan(gpu), _Visibility(gpu)
        self._first_row = 0

    def encode(self, commands: Commands, table: OrdinateTable, first_row: int) -> None:
        """Sample them into the rows of `table` from `first_row` on."""
        self._first_row = first_row
        found = [p for p in self._params(first_row, table.scale) if p[0].layers]
        if not found:
            return
        # The weight of each tile of texels, and the running sum over all tiles of all maps.
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
        # One texel at each equal step of the sum.
        for maps, params in found:
            self._pick.dispatch(
                commands,
                (self._from.count,),
                params=params,
                **_bound(maps),
                tiles=self._tiles,
                lattice=self._from.placement.params(),
                lattice_walls=self._from.blockers.walls,
                ordinates=table.rows,
                light_cells=self._light_cells,
            )

    def encode_visibility(self, commands: Commands, params: MediumParams, passed: Buffer) -> None:
        """Fill the shares of their light, 0..1, in the second part of `passed`."""
        rows = VirtualVisibilityParams(count=self._from.count, first_row=self._first_row)
        self._visibility.dispatch(
            commands,
            (self._medium.cells, self._from.count),
            params=params,
            virtual_lights=rows,
            lattice=self._from.placement.params(),
            **self._from.blockers.bound,
            light_cells=self._light_cells,
            reach=self._medium.density.reach,
            passed=passed,
        )

    def _params(
        self, first_row: int, scale: float
    ) -> list[tuple[ReflectiveShadowMaps, VirtualParams]]:
        """The maps, each set with its parameters."""
        # Texels count by what they send into the sphere around the whole medium, of which a finer
        # grid holds a part.
        whole = self._medium.whole.placement
        half = 0.5 * whole.extent
        centre = whole.world_from_medium[:3, :3] @ half + whole.world_from_medium[:3, 3]
        to_world = self._medium.placement.world_from_medium
        # The sums of all maps' tiles lie in one row, map after map.
        firsts = np.cumsum([0, *self._tiles_of])
        return [
            (
                maps,
                VirtualParams(
                    medium_from_world=np.linalg.inv(to_world),
                    centre=centre,
                    radius=float(np.linalg.norm(half)),
                    resolution=maps.resolution,
                    side=_side(maps),
                    layers=maps.layers,
                    first_tile=int(firsts[k]),
                    all_tiles=int(firsts[-1]),
                    count=self._from.count,
                    first_row=first_row,
                    scale=scale,
                    kind=self._kind,
                ),
            )
            for k, maps in enumerate(self._from.maps)
        ]


def _side(maps: ReflectiveShadowMaps) -> int:
    return -(-maps.resolution // TILE)


def _bound(maps: ReflectiveShadowMaps) -> dict[str, object]:
    return {"views": maps.views, "depth": maps.depth, "normal": maps.normal, "flux": maps.flux}
