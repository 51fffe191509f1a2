"""Light that is unscattered in the reduced medium, light by light.

The lattice solves for the reduced medium (see `reduced`), in which light that is scattered forwards
counts as unscattered. Marching scatters its irradiance Phi T' towards the eye by fused_phase; the
part that the true medium would have attenuated, Phi (T' - T), lights surfaces. Light of directional
lights is blurred across their direction by .29 sqrt(2 (1 - g)) of its path in the medium, as far as
walls let it.
Source: ours. differs: Billeter2012 knows isotropic media only.
"""

from __future__ import annotations

import math

from ..fields import FORWARD_REACH, ForwardSource
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, u32, vec3u
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import Slot, image, storage, texture, uniform
from ..lattice.placement import LatticeParams, Placement
from ..media.gpu_media import GpuMedia
from ..scene.lights import AreaLight, DirectionalLight, Light
from ..scene.scene import Scene
from .cell_lights import CELL_LIGHT_SLOTS, CellLights

_LARGEST = 1000.0  # what the brightest light becomes; half floats go to 65504
_SKY_STRIDE = 4  # every fourth part of a cell for each of a sky's many lights


class ForwardParams(Struct):
    """Which lights shine, and how finely cells are sampled."""

    light_count = u32()
    stride = u32("every so many of a cell's eight parts")
    is_blurred = u32("1: directional lights are blurred across their direction")
    scale = f32("stored units per W m^-2")


class _Forward(ComputePass):
    """forward = base + fluence and flux per cell, W m; `stores` each light's in a texture."""

    workgroup = (32, 4, 2)
    file = "forward.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia, *, stores: bool) -> None:
        own: tuple[Slot, ...] = (image("unblurred", "rgba16float", "3d"),) if stores else ()
        self.slots = (  # type: ignore[misc]
            uniform("params", ForwardParams),
            uniform("lattice", LatticeParams),
            *CELL_LIGHT_SLOTS,
            storage("face_visibility", "vec2u"),
            *media.slots,
            storage("base", "vec4f"),
            storage("forward", "vec4f", "read_write"),
            *own,
        )
        super().__init__(gpu, generated=media.wgsl + (_KEEP if stores else _DROP))


class BlurParams(Struct):
    """What is averaged, and along which axis."""

    count = vec3u("cells")
    lights = u32()
    axis = u32()


class _Blur(ComputePass):
    slots = (
        uniform("params", BlurParams),
        storage("face_visibility", "vec2u"),
        texture("light", "3d"),
        image("blurred", "rgba16float", "3d"),
    )
    workgroup = (32, 4, 2)
    file = "forward_blur.wgsl"


_DROP = "fn store_light(id: vec3u, i: u32, light: vec4f) {}\n"
_KEEP = """
fn store_light(id: vec3u, i: u32, light: vec4f) {
    let stored = clamp(light.rgb * params.scale, vec3f(0.0), vec3f(65504.0));
    textureStore(unblurred, vec3u(id.xy, id.z + i * lattice.count.z), vec4f(stored, light.a));
}
"""


class ForwardLight:
    """The sky's and all lights' forward light in cells, W m, and each light's own for marching."""

    def __init__(
        self, gpu: Gpu, placement: Placement, media: GpuMedia, sky_media: GpuMedia, light_count: int
    ) -> None:
        self.placement, self.light_count = placement, light_count
        self._lights = _Forward(gpu, media, stores=True)
        self._sky = _Forward(gpu, sky_media, stores=False)
        self._media, self._sky_media = media, sky_media
        # Sums in cells, and each light by itself, light behind light along z.
        x, y, z = placement.count
        cells = x * y * z
        self.sky = Buffer(gpu, "forward light of the sky", 3 * cells * 16)
        self.all = Buffer(gpu, "forward light", 3 * cells * 16)
        size = (x, y, z * max(1, light_count))
        self.unblurred, self.blurred, self._between = (
            Texture(gpu, name, size, "rgba16float", dimension="3d", written=True)
            for name in ("forward light by light", "blurred forward light", "half blurred light")
        )
        self._blur = _Blur(gpu, generated=f"const REACH = {FORWARD_REACH}u;")
        self.scale = 1.0

    def encode_sky(
        self, commands: Commands, lights: CellLights, *, black: Buffer, face_visibility: Buffer
    ) -> None:
        """Of the lights that stand for the sky; `black`: no light, of three channels."""
        params = ForwardParams(
            light_count=lights.count, stride=_SKY_STRIDE, is_blurred=0, scale=1.0
        )
        self._sky.dispatch(
            commands,
            self.placement.count,
            params=params,
            lattice=self.placement.params(),
            face_visibility=face_visibility,
            base=black,
            forward=self.sky,
            **lights.bound,
            **self._sky_media.bound,
        )

    def encode(
        self,
        commands: Commands,
        scene: Scene,
        lights: CellLights,
        *,
        base: Buffer,
        face_visibility: Buffer,
    ) -> None:
        """Of the scene's lights, on top of `base`: the sky's, or no light."""
        self.scale = _scale(scene.lights, self.placement.cell)
        # Each light's forward light in all cells, for marching, and the sum of all for surfaces.
        params = ForwardParams(light_count=lights.count, stride=1, is_blurred=1, scale=self.scale)
        self._lights.dispatch(
            commands,
            self.placement.count,
            params=params,
            lattice=self.placement.params(),
            face_visibility=face_visibility,
            base=base,
            forward=self.all,
            unblurred=self.unblurred,
            **lights.bound,
            **self._media.bound,
        )
        # Marching takes the blurred light where beams have spread over more than a cell.
        if lights.count:
            self._encode_blur(commands, lights.count, face_visibility)

    def _encode_blur(self, commands: Commands, lights: int, face_visibility: Buffer) -> None:
        x, y, z = self.placement.count
        # Along x, y and z in turn.
        unblurred, blurred, between = self.unblurred, self.blurred, self._between
        for axis, (light, target) in enumerate(
            ((unblurred, blurred), (blurred, between), (between, blurred))
        ):
            self._blur.dispatch(
                commands,
                (x, y, z * lights),
                params=BlurParams(count=self.placement.count, lights=lights, axis=axis),
                face_visibility=face_visibility,
                light=light,
                blurred=target,
            )

    def source(self, table: Buffer) -> ForwardSource:
        """For marching; `table` of lights."""
        count = self.light_count
        return ForwardSource(
            self.unblurred,
            self.blurred,
            table,
            count,
            max(1, count),
            1.0 / self.scale,
            self.placement.cell,
        )


def _scale(lights: tuple[Light, ...], cell_size_m: float) -> float:
    """Stored units per W m^-2: no light half a cell away is too bright for half floats."""
    largest = max(
        (
            max(x.irradiance)
            if isinstance(x, DirectionalLight)
            else max(x.intensity) / (0.5 * cell_size_m) ** 2
            for x in lights
            if not isinstance(x, AreaLight)
        ),
        default=0.0,
    )
    return float(2.0 ** math.floor(math.log2(_LARGEST / max(largest, 1e-20))))
