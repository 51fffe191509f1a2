"""Where lights shine on surfaces, as far as the image sees it: what guides rays of a gather.

Texels of reflective shadow maps are what lights shine on. Tiles of them, weighted by what points
of the image get of their light, are put together to a few patches of tiles that are near to each
other (k-means): spheres, towards which rays are sent (`maths.light_guide`).
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec2u, vec3f
from ..gpu.memory import Buffer
from ..gpu.rows import table
from ..gpu.slots import storage, texture, uniform
from ..maths.light_guide import PATCHES
from ..rays.rays import RAY_SLOTS, RayScene
from ..surface.light_views import LightViewData
from ..surface.reflective import ReflectiveShadowMaps
from .points import Points

TILE = 8
"""Texels along a side of what is put together at once."""
_NEAR = 0.02  # of a scene's diagonal: what is nearer to a point counts no more than there


class LightPatch(Struct):
    """A sphere around what lights shine on."""

    centre = vec3f("m")
    radius = f32("m; in the row behind the last patch, how many there are")
    normal = vec3f("mean of the lit surfaces, shorter where they differ")
    flux = f32("W, luminance that they reflect")


class LitTile(Struct):
    """What a light shines on in a tile of texels of its map, on the near side of its edges."""

    centre = vec3f("m")
    radius = f32("m")
    normal = vec3f("mean")
    flux = f32("W, luminance, of all of its texels")
    seen = f32("m^-2, what some points of the image get of its light, per unit of that")
    weight = f32("what tiles around give to points, by its flux")
    running = f32("sum of the weights up to it")


class TileParams(Struct):
    """A set of maps, and where its tiles are written."""

    reduced = vec2u("points of blocks")
    resolution = u32("texels")
    side = u32("tiles along a map's side, a power of two")
    layers = u32()
    first_tile = u32()
    near2 = f32("m^2, squared distance nearer than which points get no more")


class PatchParams(Struct):
    """How many tiles and points there are."""

    reduced = vec2u("points of blocks")
    count = u32("tiles")


class _Tiles(ComputePass):
    slots = (
        uniform("params", TileParams),
        table("views", LightViewData),
        texture("depth", "2d-array", "depth"),
        texture("normal", "2d-array", "unfilterable-float"),
        texture("flux", "2d-array", "unfilterable-float"),
        texture("places", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        *RAY_SLOTS,
        storage("tiles", LitTile, "read_write"),
    )
    workgroup = (64, 1, 1)
    file = "lit_tiles.wgsl"


class PatchesOfTiles(ComputePass):
    """Lit tiles -> patches of them."""

    slots = (
        uniform("params", PatchParams),
        texture("places", "2d", "unfilterable-float"),
        texture("normals", "2d", "unfilterable-float"),
        storage("tiles", LitTile, "read_write"),
        storage("lit_patches", LightPatch, "read_write"),
    )
    workgroup = (256, 1, 1)
    file = "lit_patches.wgsl"


class LightGuide:
    """`patches` holds PATCHES rows of `LightPatch`, and one that says how many of them count."""

    def __init__(self, gpu: Gpu) -> None:
        self._gpu = gpu
        self._scope = gpu.scope()
        # Compiled for what rays meet in the scene, and again where that is other.
        self._pass: _Tiles | None = None
        self._constants: dict[str, float] = {}
        self._patches = PatchesOfTiles(gpu)
        self._tiles: Buffer | None = None
        self.patches = Buffer(gpu, "lit patches", LightPatch.dtype.itemsize * (PATCHES + 1))

    def encode(
        self,
        commands: Commands,
        maps: tuple[ReflectiveShadowMaps, ...],
        points: Points,
        scene: RayScene,
        diagonal: float,
    ) -> bool:
        """Find the patches of the lights' `maps` for these points; whether there are any.

        `diagonal`, m: of the scene.
        """
        # Without maps it is not known what lights shine on.
        drawn = [one for one in maps if one.layers]
        if not drawn:
            return False
        counts = [_side(one) ** 2 * one.layers for one in drawn]
        tiles_of, tiles = self._made(scene, sum(counts))
        # What each tile holds, and how much of that the image gets; then patches of them.
        seen = {"places": points.places, "normals": points.normals}
        for k, one in enumerate(drawn):
            tiles_of.dispatch(
                commands,
                (counts[k],),
                params=TileParams(
                    reduced=points.blocks,
                    resolution=one.resolution,
                    side=_side(one),
                    layers=one.layers,
                    first_tile=sum(counts[:k]),
                    near2=(_NEAR * diagonal) ** 2,
                ),
                views=one.views,
                depth=one.depth,
                normal=one.normal,
                flux=one.flux,
                **seen,
                **scene.bound,
                tiles=tiles,
            )
        self._patches.dispatch(
            commands,
            (256,),
            params=PatchParams(reduced=points.blocks, count=sum(counts)),
            **seen,
            tiles=tiles,
            lit_patches=self.patches,
        )
        return True

    def _made(self, scene: RayScene, count: int) -> tuple[_Tiles, Buffer]:
        """The pass over tiles, and a buffer for `count` of them."""
        # A hierarchy of other constants needs another pass; more maps a larger buffer.
        if self._pass is None or self._constants != scene.constants:
            self._constants = scene.constants
            made = f"const TILE = {TILE}u;\n"
            self._pass = _Tiles(self._gpu, constants=self._constants, generated=made)
        nbytes = LitTile.dtype.itemsize * count
        if self._tiles is None or self._tiles.nbytes != nbytes:
            self._scope.release()
            self._tiles = Buffer(self._scope, "lit tiles", nbytes)
        return self._pass, self._tiles


def _side(maps: ReflectiveShadowMaps) -> int:
    # A power of two, since tiles lie along a Morton curve.
    return 1 << (-(-maps.resolution // TILE) - 1).bit_length()
