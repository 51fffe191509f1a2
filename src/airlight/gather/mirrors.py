"""What mirrors and glossy surfaces show, along rays of their pixels.

list -> a ray of each listed pixel -> what it meets, lit as pixels are -> shared between pixels as
far as their lobes are wide -> radiance towards the eye
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..fields import Fields
from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, mat4x4f, u32, vec2f, vec2u, vec3f
from ..gpu.memory import Buffer, Texture, buffer_of
from ..gpu.slots import Slot, image, storage, texture, uniform
from ..lighting.gathered import Mirrored
from ..lighting.hits import HitLighting
from ..lighting.kit import Kit
from ..lighting.lighting import RadianceLayers
from ..lighting.view import View
from ..maths.area_light import cosine_table
from ..rays.rays import RAY_SLOTS, RayScene
from ..surface.hits import Hits
from .air import Air, light_in
from .albedo import AlbedoData, Albedos
from .trace import Segment

MOST_HITS = 1 << 19
"""Rays that are lit at once."""
_REACH = 0.02  # of the image's height, within which pixels share rays in the first sample
_KINDS = "const NOWHERE = 0.0;\nconst LEFT = 1.0;\nconst MET = 2.0;\n"
_NO_AIR = "fn air_of(row: u32) -> Air { return Air(vec3f(0.0), vec3f(1.0)); }\n"
_AIR = "fn air_of(row: u32) -> Air { return Air(air[row].rgb, air[row + 1u].rgb); }\n"


class MirrorParams(Struct):
    """The camera, and which rows of the list are followed."""

    world_from_clip = mat4x4f()
    eye = vec3f("m")
    first = u32("row of the list")
    size = vec2f("px")
    batch = vec2u("texels")
    sample = u32("of the still")
    reach = f32("px, within which pixels share rays")
    texel = f32("m, how wide a pixel is one metre away")
    pad = u32()


_PIXELS: tuple[Slot, ...] = (
    uniform("params", MirrorParams),
    texture("depth", "2d", "depth"),
    texture("albedo", "2d", "unfilterable-float"),
    texture("normal", "2d", "unfilterable-float"),
    texture("emission", "2d", "unfilterable-float"),
)
_FOUND: tuple[Slot, ...] = tuple(
    texture(name, "2d", "unfilterable-float")
    for name in ("hit_positions", "hit_normals", "hit_albedos")
)


class _List(ComputePass):
    slots = (
        *_PIXELS,
        storage("found", "atomic<u32>", "read_write"),
        storage("listed", "u32", "read_write"),
        image("rows", "r32uint"),
    )
    file = "mirror_list.wgsl"


class _Rays(ComputePass):
    slots = (
        *(slot for slot in _PIXELS if slot.name not in ("albedo", "emission")),
        *RAY_SLOTS,
        storage("albedo_rows", AlbedoData),
        storage("albedo_texels", "u32"),
        storage("found", "u32"),
        storage("listed", "u32"),
        image("starts", "rgba32float"),
        image("hit_positions", "rgba32float"),
        image("hit_normals", "rgba16float"),
        image("hit_albedos", "rgba16float"),
    )
    file = "mirror_rays.wgsl"


class _Light(ComputePass):
    file = "mirror_light.wgsl"

    def __init__(self, gpu: Gpu, *, has_air: bool) -> None:
        self.slots = (  # type: ignore[misc]
            uniform("params", MirrorParams),
            texture("starts", "2d", "unfilterable-float"),
            *_FOUND,
            texture("direct_light", "2d", "unfilterable-float"),
            texture("indirect_light", "2d", "unfilterable-float"),
            storage("found", "u32"),
            *((storage("air", "vec4f"),) if has_air else ()),
            storage("mirrored", "vec4f", "read_write"),
        )
        super().__init__(gpu, generated=_KINDS + (_AIR if has_air else _NO_AIR))


class _Mirrors(ComputePass):
    slots = (
        *_PIXELS,
        texture("rows", "2d", "uint"),
        storage("mirrored", "vec4f"),
        storage("cosines", "vec4f"),
        image("mirrored_sky", "rgba32float"),
        image("mirrored_light", "rgba32float"),
    )
    file = "mirrors.wgsl"


class Mirrors:
    """Follows mirrored rays. `lighting` lights what they meet, `air` is what they go through."""

    def __init__(self, kit: Kit, lighting: HitLighting, air: Air | None) -> None:
        """As for `GatherSolver`."""
        gpu = kit.gpu
        self._kit, self.lighting, self._air = kit, lighting, air
        self._list, self._light = _List(gpu), _Light(gpu, has_air=air is not None)
        self._resolve = _Mirrors(gpu, generated=_KINDS)
        table = np.zeros((cosine_table().shape[0] ** 2, 8), np.float32)
        table[:, :6] = cosine_table().reshape(-1, 6)
        self._cosines = buffer_of(gpu, "transformed cosines", table)
        self._rays: tuple[dict[str, float], _Rays] | None = None
        self._scope = gpu.scope()
        self._sized: _Sized | None = None

    def encode(
        self, commands: Commands, view: View, fields: Fields, rays: RayScene, albedos: Albedos
    ) -> Mirrored:
        """What the view's pixels mirror; its G-buffer is drawn."""
        if self._rays is None or self._rays[0] != rays.constants:
            self._rays = (rays.constants, _Rays(self._kit.gpu, constants=rays.constants))
        sized = self._fitted(view.size)
        pixels = {**view.gbuffer.bound}
        with commands.stage("mirrored rays"):
            commands.encoder.clear_buffer(sized.found.handle)
            self._list.dispatch(
                commands,
                view.size,
                params=sized.params(view, 0),
                **pixels,
                found=sized.found,
                listed=sized.listed,
                rows=sized.rows,
            )
        for first in range(0, view.size[0] * view.size[1], sized.count):
            self._follow(commands, view, fields, first, (rays, albedos))
        with commands.stage("mirrored rays"):
            self._resolve.dispatch(
                commands,
                view.size,
                params=sized.params(view, 0),
                **pixels,
                rows=sized.rows,
                mirrored=sized.mirrored,
                cosines=self._cosines,
                mirrored_sky=sized.out.sky,
                mirrored_light=sized.out.light,
            )
        return sized.out

    def _follow(
        self,
        commands: Commands,
        view: View,
        fields: Fields,
        first: int,
        met: tuple[RayScene, Albedos],
    ) -> None:
        """Trace and light a batch of the list's rays."""
        assert self._rays is not None and self._sized is not None
        sized, params = self._sized, self._sized.params(view, first)
        gbuffer, hits = view.gbuffer.bound, sized.hits
        found = {
            "hit_positions": hits.positions,
            "hit_normals": hits.normal,
            "hit_albedos": hits.albedo,
        }
        with commands.stage("mirrored rays"):
            self._rays[1].dispatch(
                commands,
                hits.size,
                params=params,
                depth=gbuffer["depth"],
                normal=gbuffer["normal"],
                **met[0].bound,
                **met[1].bound,
                found=sized.found,
                listed=sized.listed,
                starts=sized.starts,
                **found,
            )
            air: dict[str, Any] = {}
            if self._air is not None and sized.air is not None:
                ends, whole = (sized.starts, hits), Segment(range(1), 0, 0.0)
                self._air.encode(commands, hits.size, ends, whole, light_in(fields), sized.air)
                air = {"air": sized.air}
        with commands.stage("mirrored light"):
            cache = fields.irradiance or self._kit.no_irradiance
            self.lighting.encode(commands, hits, sized.layers, cache, fields.sky)
            self._light.dispatch(
                commands,
                hits.size,
                params=params,
                starts=sized.starts,
                **found,
                direct_light=sized.layers.direct,
                indirect_light=sized.layers.indirect,
                found=sized.found,
                **air,
                mirrored=sized.mirrored,
            )

    def _fitted(self, size: tuple[int, int]) -> _Sized:
        if self._sized is None or self._sized.size != size:
            self._scope.release()
            self._sized = None
            self._sized = _Sized(self._scope, size, has_air=self._air is not None)
        return self._sized


class _Sized:
    """What depends on the image's size; `count`: of the rays of a batch."""

    def __init__(self, gpu: Gpu, size: tuple[int, int], *, has_air: bool) -> None:
        self.size = size
        width, height = size
        batch = (width, max(1, min(height, MOST_HITS // width)))
        self.count = batch[0] * batch[1]
        self.found = Buffer(gpu, "mirroring pixels", 16)
        self.listed = Buffer(gpu, "list of mirroring pixels", 4 * width * height)
        self.mirrored = Buffer(gpu, "mirrored rays", 32 * width * height)
        self.rows = Texture(gpu, "rows of mirroring pixels", size, "r32uint", written=True)
        self.hits, self.layers = Hits(gpu, batch), RadianceLayers(gpu, batch)
        self.starts = Texture(gpu, "starts of mirrored rays", batch, "rgba32float", written=True)
        self.air = Buffer(gpu, "air along mirrored rays", 32 * self.count) if has_air else None
        sky, light = (
            Texture(gpu, label, size, "rgba32float", written=True)
            for label in ("mirrored sky", "mirrored light")
        )
        self.out = Mirrored(sky, light)

    def params(self, view: View, first: int) -> MirrorParams:
        """For the rows of the list from `first` on."""
        down = view.world_from_clip[:3, 1] / view.world_from_clip[3, 2]
        return MirrorParams(
            world_from_clip=view.world_from_clip,
            eye=view.eye,
            first=first,
            size=self.size,
            batch=self.hits.size,
            sample=view.sample,
            reach=max(1.0, _REACH * self.size[1]) * (view.sample + 1) ** -0.25,
            texel=float(np.linalg.norm(down)) * 2.0 / self.size[1],
            pad=0,
        )
