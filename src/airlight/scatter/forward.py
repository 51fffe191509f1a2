"""Light that is unscattered in the reduced medium, light by light.

The lattice solves for the reduced medium (see `reduced`), in which light that is scattered forwards
counts as unscattered. Marching scatters its irradiance Phi T' towards the eye by fused_phase; the
part that the true medium would have attenuated, Phi (T' - T), lights surfaces. Light of directional
lights was deflected once, anywhere on its path in the medium alike: some way back along its
direction, and by sqrt(1 - g) of that aside (the deviation along each axis; Henyey and Greenstein's
mean squared deflection is about 2 (1 - g)). What lies behind a wall does not come.
Source: ours. differs: Billeter2012 knows isotropic media only.
"""

from __future__ import annotations

from typing import Any

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32
from ..gpu.memory import Buffer
from ..gpu.slots import Slot, image, storage, uniform
from ..lattice.lattices import Level
from ..lattice.placement import LatticeParams, Placement
from ..media.gpu_media import GpuMedia
from ..media.sky_in_media import sky_points
from ..media.stale_cells import ALL_CELLS, LISTED_CELLS, STALE_CELL_SLOTS, StaleCells
from .cell_lights import ALL_LIGHTS, CELL_LIGHT_SLOTS, SKY_LIGHTS, CellLights
from .cells import LatticeCells
from .forward_textures import ForwardTextures
from .reduced_media import SLANT_MEDIA, ReducedMedia

_PARTS = 8
_FEW = 4  # lights of which surfaces alone have every part of a cell; else every second, in turn


class ForwardParams(Struct):
    """Which lights shine, and how finely cells are sampled."""

    light_count = u32()
    stride = u32("every so many of a cell's eight parts")
    scale = f32("stored units per W m^-2")
    depth = u32("cells along z of the textures that each light has")
    taps = u32("of each part, where directional lights are blurred")
    light_step = u32("every so many of the lights counts as all of these")
    is_listed = u32("1: cells of the list alone")


class _Forward(ComputePass):
    """forward = base + fluence and flux per cell, W m; `stores` each light's in a texture.

    `is_near`: only in cells `near` surfaces. Else what stores none may compute cells of a list.
    """

    workgroup = (32, 4, 2)
    file = "forward.wgsl"

    def __init__(
        self, gpu: Gpu, media: GpuMedia, *, stores: bool, is_near: bool, is_sky: bool
    ) -> None:
        # Beside the common slots: a texture to blur, near surfaces, or a list of stale cells.
        own: tuple[Slot, ...] = (image("unblurred", "rgba16float", "3d"),) * stores
        own += (storage("near", "u32"),) * is_near
        is_listed = not (stores or is_near)
        own += STALE_CELL_SLOTS * is_listed
        self.slots = (
            uniform("params", ForwardParams),
            uniform("lattice", LatticeParams),
            *CELL_LIGHT_SLOTS,
            storage("face_visibility", "vec2u"),
            *media.slots,
            storage("base", "vec4f"),
            storage("forward", "vec4f", "read_write"),
            *own,
        )
        cells = LISTED_CELLS if is_listed else ALL_CELLS
        generated = media.wgsl + cells + _SLANT_MEDIA + _generated(stores, is_near)
        generated += SKY_LIGHTS if is_sky else ALL_LIGHTS
        super().__init__(gpu, generated=generated)


_SLANT_MEDIA = f"const SLANT_MEDIA = {SLANT_MEDIA}u;\n"
# Light by light it is kept for marching, which the sum for surfaces does without.
_DROP = """fn store_light(id: vec3u, i: u32, light: vec4f) {}
"""
_KEEP = """fn store_light(id: vec3u, i: u32, light: vec4f) {
    let stored = clamp(light.rgb * params.scale, vec3f(0.0), vec3f(65504.0));
    let texel = id + vec3u(0u, lattice.first_row, i * params.depth);
    textureStore(unblurred, texel, vec4f(stored, light.a));
}
"""


def _generated(stores: bool, is_near: bool) -> str:
    # Where it is for surfaces alone, cells that none of them reads are left out.
    cells = "near[cell] != 0u" if is_near else "true"
    return (
        f"const FOR_SURFACES = {str(is_near).lower()};\n"
        + f"fn is_read(cell: u32) -> bool {{ return {cells}; }}\n"
        + (_KEEP if stores else _DROP)
    )


class ForwardLight:
    """The sky's and all lights' forward light in the cells of one lattice, W m.

    Each light's own goes into the `textures` for marching. Without them the light is for surfaces
    alone, in cells that they read.
    """

    def __init__(
        self,
        gpu: Gpu,
        placement: Placement,
        media: ReducedMedia,
        textures: ForwardTextures | None = None,
    ) -> None:
        self._media, self._textures = media, textures
        # Without textures it is for surfaces alone, in the cells that they read.
        is_near = textures is None
        self._lights = _Forward(
            gpu, media.lights, stores=not is_near, is_near=is_near, is_sky=False
        )
        self._sky = _Forward(gpu, media.sky, stores=False, is_near=is_near, is_sky=True)
        self.sky = Buffer(gpu, "forward light of the sky", 3 * placement.cells * 16)
        self.all = Buffer(gpu, "forward light", 3 * placement.cells * 16)

    def encode_sky(
        self,
        commands: Commands,
        cells: LatticeCells | Level,
        lights: CellLights,
        *,
        base: Buffer,
        near: Buffer | None = None,
        stale: StaleCells | None = None,
        light_step: int = 1,
    ) -> None:
        """Of the lights that stand for the sky, on top of `base`: no light.

        `light_step`: cells take each so many of the lights, neighbours others. `stale`, where the
        light is not for surfaces alone: the cells that are computed.
        """
        # Each of the sky's lights is looked for at one or two parts of a cell; none is blurred.
        params = ForwardParams(
            light_count=lights.count,
            stride=_PARTS if self._textures is None else _PARTS // sky_points(lights.count),
            scale=1.0,
            depth=0,
            taps=1,
            light_step=light_step,
            is_listed=bool(stale and stale.is_listed),
        )
        self._sky.dispatch(
            commands,
            cells.placement.count,
            params=params,
            forward=self.sky,
            **_bound(cells, base, near),
            **(stale.bound if stale else {}),
            **lights.bound,
            **self._media.sky.bound,
        )

    def encode(
        self,
        commands: Commands,
        cells: LatticeCells | Level,
        lights: CellLights,
        *,
        base: Buffer,
        near: Buffer | None = None,
    ) -> None:
        """Of the scene's lights, on top of `base`: the sky's, or no light.

        `near`: of light for surfaces alone, the cells that they read (`near_surfaces`).
        """
        # Each light's forward light in all cells, for marching, and the sum of all for surfaces.
        textures = self._textures
        params = ForwardParams.of(
            light_count=lights.count,
            # Many lights are samples of few with extent.
            stride=1 if textures or lights.count <= _FEW else 2,
            scale=textures.scale if textures else 1.0,
            depth=textures.depth if textures else 0,
            taps=self._media.taps,
            light_step=1,
            is_listed=0,
        )
        self._lights.dispatch(
            commands,
            cells.placement.count,
            params=params,
            forward=self.all,
            **_bound(cells, base, near),
            **({"unblurred": textures.unblurred} if textures else {}),
            **lights.bound,
            **self._media.lights.bound,
        )
        # Marching takes the blurred light where beams have spread over more than a cell.
        if textures and lights.count:
            textures.encode_blur(
                commands, cells.placement, lights.count, cells.blockers.face_visibility
            )


def _bound(cells: LatticeCells | Level, base: Buffer, near: Buffer | None) -> dict[str, Any]:
    """What the light of the sky and that of lights are both computed from."""
    return {
        "lattice": cells.placement.params(),
        "face_visibility": cells.blockers.face_visibility,
        "base": base,
        **({"near": near} if near else {}),
    }
