"""March eye rays through solved in-scattered radiance, front to back.

Source and extinction are constant within a step, the integral over it is exact (Billeter2012
section 4.3; the volume rendering equation of Max 1995). Steps end at the borders of media and
are no longer than the voxels of a grid inside it.

Sources come in two forms: a texture of emission J (W m^-3 sr^-1; or, times the scattering
coefficient of one or all media, of mean radiance), and a solved lattice of two-band states. What
arrives from the sky is a lattice of its own, and a picture of its own: light scattered once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..gpu.commands import Commands
from ..gpu.compute import ComputePass
from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, i32, mat4x4f, pack_array, u32
from ..gpu.memory import Buffer, Texture, linear_sampler
from ..gpu.slots import Slot, image, sampler, storage, texture, uniform
from ..lattice.placement import LatticeParams, Placement
from ..lattice.table import LatticeTable
from ..maths.transforms import F64
from .air import Air
from .forward_source import FORWARD_WGSL, ForwardSource, forward_slots
from .rays import RayParams, Rays

ABSOLUTE, ALL_MEDIA = -1, -2
MAX_SOURCES = 4


class MarchParams(Struct):
    """How rays are cut into steps, and how the lattice is read."""

    step = f32("m")
    max_steps = u32()
    cutoff = f32("transmittance below which a ray ends")
    lattice_scale = f32("W m^-2 sr^-1 per stored unit of a")
    lattice_direct = f32("share of b that the phase function keeps, per g")
    sky_scale = f32("W m^-2 sr^-1 per stored unit of a")
    sky_direct = f32("share of b that the phase function keeps, per g")
    forward_scale = f32("W m^-2 per stored unit of light scattered forwards")
    forward_slabs = f32("lights that its texture holds along z")
    forward_count = u32("of which so many shine")


class SourceData(Struct):
    """One source texture; its box is 0..1 on each axis of its own space."""

    uvw_from_world = mat4x4f()
    scale = f32("W m^-3 sr^-1 per stored unit, or W m^-2 sr^-1 before scattering")
    medium = i32("-1 absolute, -2 times sigma_s of all media, else of this one")


@dataclass(frozen=True, eq=False)
class Source:
    """Emission on a grid: rgb of an rgba16float (or wider, filterable) 3D texture.

    With `medium` ABSOLUTE, texel * `scale` is J in W m^-3 sr^-1. Otherwise it is mean radiance,
    W m^-2 sr^-1 (fluence/4pi), and is multiplied by the scattering coefficient of ALL_MEDIA, or
    of one (its row: the scene's medium first, then the volumes), at the density's own resolution.
    """

    texture: Texture
    uvw_from_world: F64
    scale: float = 1.0
    medium: int = ABSOLUTE

    @property
    def cell_m(self) -> float:
        """The shortest side of its cells, metres."""
        lengths = np.linalg.norm(np.linalg.inv(self.uvw_from_world)[:3, :3], axis=0)
        return float((lengths / np.array(self.texture.size)).min())


@dataclass(frozen=True, eq=False)
class LatticeSource:
    """Solved lattices of states (a, b): radiance `scale` * (a + `direct` g b.w) per sigma_s.

    `bound`: lattice_red/green/blue (or sky_red/green/blue) and the blockers' lattice_open_a/b and
    lattice_walls. For the
    lookup's normalisation (NOTES section 1) scale = (2/3)/(s^2 power_scale), direct = 1; for
    accumulated track length V, scale = 1/(4 pi s^3 power_scale), direct = 3.
    `finer`: lattices inside this one that share its textures, the finest first. Steps are as long
    as the cells of the finest that has the place (Kaplanyan2010 section 7).
    `forward`: what is near its beam still, where the pass has been made for it.
    """

    placement: Placement
    bound: dict[str, Any]
    scale: float
    direct: float = 1.0
    finer: tuple[Placement, ...] = ()
    forward: ForwardSource | None = None

    @property
    def levels(self) -> tuple[Placement, ...]:
        """All its lattices, the finest first."""
        return (*self.finer, self.placement)

    @property
    def cell_m(self) -> float:
        """The side of its smallest cells, metres."""
        return self.levels[0].cell


def placed(placement: Placement) -> F64:
    """(4, 4): the world to a lattice's texture coordinates."""
    extent = placement.cell * np.array(placement.count, np.float64)
    matrix = np.diag([*(1.0 / extent), 1.0])
    matrix[:3, 3] = -np.array(placement.origin) / extent
    return matrix


class March(ComputePass):
    """Scattered radiance and transmittance of every picked ray."""

    workgroup = (8, 8, 1)

    def __init__(
        self, gpu: Gpu, air: Air, *, sources: int = 0, has_lattice: bool = False,
        has_sky: bool = False, has_forward: bool = False,
    ) -> None:  # fmt: skip
        """`has_forward`: the lattice always brings a ForwardSource; else it may, at some cost."""
        own = forward_slots() if has_forward else ()
        self.slots = (*_slots(air, sources, has_lattice, has_sky), *own)  # type: ignore[misc]
        generated = (
            air.medium_wgsl + _sources_wgsl(sources, has_lattice, has_sky) + _sky_wgsl(has_sky)
        )
        super().__init__(gpu, generated=generated + (FORWARD_WGSL if has_forward else _NO_FORWARD))
        self._air, self._linear = air, linear_sampler(gpu)
        self._table = Buffer(gpu, "sources", SourceData.dtype.itemsize * max(1, sources))
        self._written = b""
        self._lattices: LatticeTable | None = None
        self.params: MarchParams | None = None  # the last ones
        self._kinds: dict[str, Any] = {
            "sources": sources,
            "has_lattice": has_lattice,
            "has_sky": has_sky,
        }
        self._has_forward = has_forward
        self._forward: March | None = None

    def encode(
        self, commands: Commands, params: RayParams, rays: Rays, *,
        sources: Sequence[Source] = (), lattice: LatticeSource | None = None,
        sky: LatticeSource | None = None, scattered: Texture, transmittance: Texture,
        skylit: Texture | None = None, steps_per_cell: float = 1.0, max_steps: int = 128,
        cutoff: float = 1e-3,
    ) -> None:  # fmt: skip
        """Fill `scattered`, `transmittance` and, from `sky`, `skylit`: of `rays.reduced` size."""
        if lattice is not None and lattice.forward is not None and not self._has_forward:
            self._with_forward.encode(
                commands, params, rays, sources=sources, lattice=lattice, sky=sky,
                scattered=scattered, transmittance=transmittance, skylit=skylit,
                steps_per_cell=steps_per_cell, max_steps=max_steps, cutoff=cutoff,
            )  # fmt: skip
            return
        values: dict[str, Any] = {}
        if sources:
            self._write(sources)
            values |= {"sources": self._table, "source_linear": self._linear}
            values |= {f"source{i}": s.texture for i, s in enumerate(sources)}
        lattices = [x for x in (lattice, sky) if x is not None]
        for one in lattices:
            values |= {"lattices": self._levels(one.levels), "linear_clamp": self._linear}
            values |= one.bound
        if sky is not None:
            # wgsl/lattice wants a lattice's textures.
            own = {f"lattice_{c}": sky.bound[f"sky_{c}"] for c in ("red", "green", "blue")}
            values = {"skylit": skylit, **own, **values}
        forward = lattice.forward if lattice else None
        if forward is not None:
            values |= {"forward_table": forward.table, "forward_lights": forward.texture}
        cells = [s.cell_m for s in sources] + [s.cell_m for s in lattices]
        self.params = march = MarchParams(
            step=min(cells, default=math.inf) / steps_per_cell if cells else 1e9,
            max_steps=max_steps, cutoff=cutoff, lattice_scale=lattice.scale if lattice else 0.0,
            lattice_direct=lattice.direct if lattice else 0.0,
            sky_scale=sky.scale if sky else 0.0, sky_direct=sky.direct if sky else 0.0,
            forward_scale=forward.scale if forward else 0.0,
            forward_slabs=forward.slabs if forward else 1.0,
            forward_count=forward.count if forward else 0,
        )  # fmt: skip
        self.dispatch(
            commands, rays.reduced, rays=params, march=march, picked=rays.picked,
            **self._air.medium_bound, **values, scattered=scattered, passed=transmittance,
        )  # fmt: skip

    @property
    def _with_forward(self) -> March:
        """The same for a lattice with light scattered forwards: its loop costs wherever it is."""
        if self._forward is None:
            self._forward = March(self.gpu, self._air, **self._kinds, has_forward=True)
        return self._forward

    def _levels(self, levels: tuple[Placement, ...]) -> Buffer:
        if self._lattices is None or self._lattices.count != len(levels):
            self._release_levels()
            self._lattices = LatticeTable(self.gpu, len(levels))
        return self._lattices.filled([level.params() for level in levels])

    def _release_levels(self) -> None:
        if self._lattices is not None:
            self._lattices.release()

    def _write(self, sources: Sequence[Source]) -> None:
        packed = pack_array(SourceData, [
            {"uvw_from_world": s.uvw_from_world, "scale": s.scale, "medium": s.medium}
            for s in sources
        ])  # fmt: skip
        if packed.tobytes() != self._written:
            self._written = packed.tobytes()
            self._table.write(packed)

    def release(self) -> None:
        """Give the memory back."""
        self._table.release()
        self._release_levels()
        if self._forward is not None:
            self._forward.release()


_NO_FORWARD = "fn forward_emission(p: vec3f, travel: vec3f) -> vec3f { return vec3f(0.0); }\n"


def _slots(air: Air, sources: int, has_lattice: bool, has_sky: bool) -> tuple[Slot, ...]:
    slots = [uniform("rays", RayParams), uniform("march", MarchParams),
             texture("picked", "2d", "unfilterable-float"), *air.medium_slots]  # fmt: skip
    if sources:
        slots += [storage("sources", SourceData), sampler("source_linear")]
        slots += [texture(f"source{i}", "3d") for i in range(sources)]
    if has_lattice or has_sky:
        slots += [storage("lattices", LatticeParams), sampler("linear_clamp")]
        slots += [
            texture(f"lattice_{name}", "3d")
            for name in ("red", "green", "blue", "open_a", "open_b", "walls")
        ]
    if has_sky:
        slots += [texture(f"sky_{name}", "3d") for name in ("red", "green", "blue")]
        slots += [image("skylit", "rgba32float")]
    slots += [image("scattered", "rgba32float"), image("passed", "rgba32float")]
    return tuple(slots)


def _sources_wgsl(sources: int, has_lattice: bool, has_sky: bool) -> str:
    """`emission_at`: the sum of all sources, unrolled, since textures cannot be indexed; and
    `step_share`: how long a step from a place is, in steps of the finest source.
    """
    parts = ["    lattice_enter(p);\n"] if has_lattice or has_sky else []
    parts += [
        f"    let uvw{i} = (sources[{i}].uvw_from_world * vec4f(p, 1.0)).xyz;\n"
        f"    if (all(uvw{i} >= vec3f(0.0)) && all(uvw{i} <= vec3f(1.0))) {{\n"
        f"        sum += textureSampleLevel(source{i}, source_linear, uvw{i}, 0.0).rgb\n"
        f"            * sources[{i}].scale * source_weight(sources[{i}].medium, p);\n    }}\n"
        for i in range(sources)
    ]
    if has_lattice:
        parts.append("    sum += lattice_emission(p, travel) + forward_emission(p, travel);\n")
    uses = "//! use march_lattice\n" if has_lattice or has_sky else ""
    if has_lattice:
        uses += _emission_wgsl("lattice", "f32(air[m].has_shafts)")
    share = "march_step_share(p)" if (has_lattice or has_sky) and not sources else "1.0"
    uses += f"fn step_share(p: vec3f) -> f32 {{ return {share}; }}\n"
    return (
        f"{uses}fn emission_at(p: vec3f, travel: vec3f) -> vec3f {{\n    var sum = vec3f(0.0);\n"
        + "".join(parts)
        + "    return sum;\n}\n"
    )


def _sky_wgsl(has_sky: bool) -> str:
    """`skylit_at`, after `emission_at` of the same place, and `store_skylit`."""
    if not has_sky:
        return (
            "fn skylit_at(p: vec3f, travel: vec3f) -> vec3f { return vec3f(0.0); }\n"
            "fn store_skylit(texel: vec2u, radiance: vec3f) {}\n"
        )
    return (
        # Whose single scattering comes with a source of its own has it from the sky too.
        _emission_wgsl("sky", "f32(air[m].has_shafts)")
        + "fn skylit_at(p: vec3f, travel: vec3f) -> vec3f { return sky_emission(p, travel); }\n"
        "fn store_skylit(texel: vec2u, radiance: vec3f) {\n"
        "    textureStore(skylit, texel, vec4f(radiance, 1.0));\n}\n"
    )


def _emission_wgsl(name: str, share: str) -> str:
    """`{name}_emission`, W m^-3 sr^-1: the phase function keeps g of the two-band direction."""
    samples = "".join(
        f"    let {c} = lattice_blended({name}_{c}, {str(name == 'lattice').lower()});\n"
        for c in ("red", "green", "blue")
    )
    channels = ", ".join(
        f"lattice_radiance({c}, travel, march.{name}_direct * g.{c[0]})"
        for c in ("red", "green", "blue")
    )
    return (
        f"fn {name}_emission(p: vec3f, travel: vec3f) -> vec3f {{\n"
        f"    if (lattice_at[0].w <= 0.0) {{ return vec3f(0.0); }}\n{samples}"
        "    var sum = vec3f(0.0);\n    for (var m = 0u; m < AIR_COUNT; m++) {\n"
        f"        let g = air[m].g;\n        sum += {share} * air_here[m] * air[m].sigma_t\n"
        f"            * air[m].albedo * vec3f({channels});\n    }}\n"
        f"    return march.{name}_scale * sum;\n}}\n"
    )
