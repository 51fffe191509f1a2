"""Direct light of emitters on surfaces: analytic, times the share of samples that is seen.

For each emitter the irradiance and the GGX response come in closed form (Heitz2016), and are
multiplied by sum(w v) / sum(w) over its samples, with v what the sample's shadow map says and w the
sample's unshadowed light (Heitz2018, section 3): where nothing shadows there is no noise at all.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.layout import Struct, mat4x4f, u32, vec2f, vec3f
from ..gpu.memory import Buffer, Texture, buffer_of
from ..gpu.rows import Table, table
from ..gpu.slots import Slot, sampler, storage, texture, uniform
from ..lattice.inject import LightAttenuation
from ..maths.area_light import cosine_table
from ..maths.transforms import F64
from ..scene.material import Material
from ..surface.gbuffer import GBuffer
from ..surface.geometry import GpuScene
from ..surface.hits import PIXELS, Hits, Points
from ..surface.light_table import LightData
from ..surface.shadow import ShadowMaps
from .emitter import Emitter
from .emitters import Emitters
from .shapes import MOST_CORNERS, Kind
from .table import (
    CornerData,
    EmitterData,
    SampleData,
    corner_rows,
    emitter_rows,
    emitter_views,
    map_spans,
    sample_rows,
)

MANY, _NONE = 8, 0xFFFFFFFF
"""Samples of an emitter, from which on half of them tell where all of it is seen, or nothing."""
MOST_TEXELS = 1 << 24
"""Of all shadow maps together; where there would be more they are smaller."""
_NO_MEDIA = """
fn media_passed(row: u32, count: u32, p: vec3f) -> vec3f { return vec3f(1.0); }
"""
_THROUGH_MEDIA = """
//! use media_light
fn media_passed(row: u32, count: u32, p: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    var k = 0u;
    loop {
        sum += media_light_transmittance(row_of_lights(row + k), row + k, p);
        k++;
        if (k >= count) { break; }
    }
    return sum / f32(count);
}
"""


class AreaLightingParams(Struct):
    """The camera, and how many emitters there are."""

    world_from_clip = mat4x4f()
    eye = vec3f("m")
    emitter_count = u32()
    size = vec2f("px")
    map_texel = vec2f("of a hemisphere's and a cube's maps, of the distance along a view's axis")
    map_scale = vec2f("1 over what they span at distance 1")
    many = u32("samples of an emitter, from which on half may tell what all see")
    has_mirrors = u32("1: rays follow what smooth surfaces mirror")


class _AreaLighting(FullscreenPass):
    """G-buffer -> emission and direct light of emitters, W m^-2 sr^-1."""

    targets = ("rgba32float",)
    file = "lighting.wgsl"

    def __init__(
        self, gpu: Gpu, media: LightAttenuation | None, has: Mapping[str, bool], points: Points
    ) -> None:
        """`has`: what the shader's overrides ask for, by their names; `points`: what is lit."""
        self.slots: tuple[Slot, ...] = (
            uniform("params", AreaLightingParams),
            points.slot,
            texture("albedo", "2d", "unfilterable-float"),
            texture("normal", "2d", "unfilterable-float"),
            texture("emission", "2d", "unfilterable-float"),
            storage("emitters", EmitterData),
            storage("corners", CornerData),
            storage("samples", SampleData),
            storage("cosines", "vec4f"),
            texture("area_shadows", "2d-array", "depth"),
            sampler("shadow_compare", "comparison"),
            *((table("lights", LightData), *media.slots) if media else ()),
        )
        super().__init__(
            gpu,
            generated=points.wgsl + ((media.wgsl + _THROUGH_MEDIA) if media else _NO_MEDIA),
            constants={name: float(value) for name, value in has.items()},
        )


def kinds(emitters: Sequence[Emitter]) -> dict[str, bool]:
    """Which kinds of emitters and samples there are, by the shader's names for them."""
    # A kind that does not occur is compiled out.
    found = {emitter.shape.kind for emitter in emitters}
    return {
        "HAS_POLYGONS": Kind.POLYGON in found,
        "HAS_SPHERES": Kind.SPHERE in found,
        "HAS_SAMPLES_ALONE": Kind.SAMPLES in found,
        "HAS_CUBES": any(s.is_cube for emitter in emitters for s in emitter.samples),
        "ARE_FLAT": all(is_flat(emitter) for emitter in emitters),
        "HAS_SEGMENTS": any(
            sample.segment is not None
            for emitter in emitters
            if emitter.shape.kind == Kind.SAMPLES
            for sample in emitter.samples
        ),
        "HAS_SPOTS": any(emitter.spot is not None for emitter in emitters),
    }


def is_flat(emitter: Emitter) -> bool:
    """Whether all samples of an emitter face the same way, and so see along the same axes."""
    # Samples that send to all sides see along axes of their own.
    directions = np.array([sample.light.direction for sample in emitter.samples])
    is_one = bool(np.abs(directions - directions[0]).max() < 1e-9)
    return is_one and not any(sample.is_cube for sample in emitter.samples)


class AreaShadows:
    """Emitters on the device with the shadow maps of their samples; drawn where they changed."""

    def __init__(self, gpu: Gpu, emitters: Emitters, resolution: int) -> None:
        """`resolution`: side of a map, texels, where there are few."""
        self.emitters = emitters
        layers = max(1, emitters.layers)
        # Shadow maps of all samples within a budget of texels.
        while resolution > 32 and layers * resolution**2 > MOST_TEXELS:
            resolution //= 2
        self.maps = ShadowMaps(gpu, "area shadows", resolution, layers, is_thinned=True)
        # Tables of emitters, their corners and samples.
        self.table = Buffer(gpu, "emitters", EmitterData.dtype.itemsize * emitters.count)
        self.corners = Buffer(
            gpu, "emitter corners", CornerData.dtype.itemsize * MOST_CORNERS * emitters.count
        )
        self.samples = Buffer(
            gpu, "emitter samples", SampleData.dtype.itemsize * emitters.sample_count
        )
        self._key: tuple[Any, ...] | None = None

    def encode(self, commands: Commands, meshes: GpuScene, index: int, low: F64, high: F64) -> None:
        """Bring tables and maps up to date for sample `index` of a still; low..high: the scene."""
        key = (self.emitters.version, meshes.version, index, low.tobytes(), high.tobytes())
        if key == self._key:
            return
        self._key = None  # until all is drawn: what raises leaves nothing to be kept
        # The samples of this image of a still, and what each of them sees of the scene.
        found = self.emitters.jittered(index)
        self.table.write(emitter_rows(found, low, high))
        self.corners.write(corner_rows(found))
        self.samples.write(sample_rows(found, low, high))
        views = [
            view
            for emitter in found
            for view in emitter_views(emitter, low, high, self.maps.resolution)
        ]
        self.maps.encode(commands, meshes, views)
        self._key = key

    @property
    def bound(self) -> dict[str, Any]:
        """By slot name."""
        return {
            "emitters": self.table,
            "corners": self.corners,
            "samples": self.samples,
            "area_shadows": self.maps.depth,
            "shadow_compare": self.maps.sampler,
        }


def cosines(gpu: Gpu) -> Buffer:
    """The table of linearly transformed cosines, read as two vectors of four a row."""
    table = np.zeros((cosine_table().shape[0] ** 2, 8), np.float32)
    table[:, :6] = cosine_table().reshape(-1, 6)
    return buffer_of(gpu, "transformed cosines", table)


class AreaLighting:
    """Draws a view's emission, and on it what emitters light."""

    def __init__(
        self,
        gpu: Gpu,
        shadows: AreaShadows,
        materials: Iterable[Material],
        media: LightAttenuation | None,
        points: Points = PIXELS,
    ) -> None:
        """`media`: what light is attenuated by on its way to surfaces of `materials`.

        `points`: whether those are pixels, or hits of rays.
        """
        self.gpu, self.shadows, self.media, self._points = gpu, shadows, media, points
        self._has_gloss = any(m.specular > 0.0 or m.metallic > 0.0 for m in materials)
        self._passes: dict[tuple[bool, ...], _AreaLighting] = {}
        self._cosines = cosines(gpu)
        self._lit: WeakKeyDictionary[GBuffer | Hits, Texture] = WeakKeyDictionary()

    def encode(
        self,
        commands: Commands,
        gbuffer: GBuffer | Hits,
        camera: tuple[F64, tuple[float, float, float]],
        lights: Table,
        *,
        emission: Texture | None = None,
        is_still: bool = False,
        has_mirrors: bool = False,
    ) -> Texture:
        """The texture that stands for the G-buffer's emission: rgb W m^-2 sr^-1, a specular.

        `camera`: world_from_clip and the eye, metres; `lights`: the table of all lights;
        `emission`: in place of the G-buffer's. In frames (not `is_still`) half of an emitter's
        samples do where they see all of it or nothing. `has_mirrors`: rays follow what smooth
        surfaces mirror, media that glow included.
        """
        lit = self._lit_of(gbuffer)
        resolution = self.shadows.maps.resolution
        spans = map_spans(resolution)
        # What every pixel needs of the camera, of maps and of emitters.
        values: dict[str, Any] = {
            "params": AreaLightingParams(
                world_from_clip=camera[0],
                eye=camera[1],
                emitter_count=self.shadows.emitters.count,
                size=gbuffer.size,
                map_texel=(spans[0] / resolution, spans[1] / resolution),
                map_scale=(1.0 / spans[0], 1.0 / spans[1]),
                many=_NONE if is_still else MANY,
                has_mirrors=int(has_mirrors),
            ),
            **gbuffer.bound,
            **({} if emission is None else {"emission": emission}),
            "cosines": self._cosines,
            **self.shadows.bound,
        }
        if self.media:
            values |= {"lights": lights, **self.media.bound}
        rows = gbuffer.rows if isinstance(gbuffer, Hits) else None
        self._pass().draw_rows(commands, (lit,), rows, **values)
        return lit

    def _lit_of(self, gbuffer: GBuffer | Hits) -> Texture:
        """The texture for the surfaces of a G-buffer, as large as it is, and gone with it."""
        lit = self._lit.get(gbuffer)
        if lit is None or lit.size[:2] != gbuffer.size:
            lit = Texture(
                self.gpu, "area light", gbuffer.size, "rgba32float", target=True, written=True
            )
            self._lit[gbuffer] = lit
        return lit

    def _pass(self) -> _AreaLighting:
        """The pass for the kinds of emitters that there are in this frame."""
        # Emitters may change their kinds: a pass for each set of them.
        has = {**kinds(self.shadows.emitters.list), "HAS_GLOSS": self._has_gloss}
        key = tuple(has.values())
        if key not in self._passes:
            self._passes[key] = _AreaLighting(self.gpu, self.media, has, self._points)
        return self._passes[key]
