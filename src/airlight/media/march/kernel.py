"""The parameters, slots and generated WGSL of the marching kernel, by the fields it marches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from ...gpu.layout import Struct, f32, i32, mat4x4f, u32
from ...gpu.slots import Slot, sampler, storage, texture, uniform
from ...lattice.placement import LatticeParams
from ..gpu_media import GpuMedia
from ..rays import RayParams
from .forward_source import FORWARD_WGSL, NO_FORWARD_WGSL, forward_slots
from .half_space import NO_HALF_SPACE_WGSL, half_space_slots, half_space_wgsl

MAX_LEVELS_AT_ONCE = 3
"""Nested lattices that fade into each other at one point."""


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
    forward_spread = f32("m^-2, see ForwardSource")
    forward_slabs = f32("lights that its texture holds along z")
    forward_count = u32("of which so many shine")
    half_space_top = f32("m, of an endless medium")
    half_space_sigma_t = f32("m^-1, of an endless medium")


class SourceData(Struct):
    """One source texture; its box is 0..1 on each axis of its own space."""

    uvw_from_world = mat4x4f()
    scale = f32("W m^-3 sr^-1 per stored unit, or W m^-2 sr^-1 before scattering")
    medium = i32("-1 absolute, -2 times sigma_s of all media, else of this one")


LatticeForm = Literal["none", "mean", "two bands", "reduced medium"]
"""What is read of a lattice: means alone, where phase functions are isotropic; both bands; means
that reduced media scatter, with both bands for what they are at the eye."""
SkyForm = Literal["none", "mean", "two bands", "three bands"]
"""Likewise; three bands where phase functions are strongly anisotropic."""
Written = Literal["light and transmittance", "light", "transmittance"]


@dataclass(frozen=True)
class Variant:
    """What is marched: source textures, a lattice, the sky's, forward light besides the lattice.

    `levels`: how many nested lattices there are at one point. `half_space_side`: directions along
    a side of the table of an endless medium, if any. `writes`: what the targets are.
    """

    sources: int = 0
    lattice: LatticeForm = "none"
    sky: SkyForm = "none"
    has_forward: bool = False
    levels: int = 1
    half_space_side: int = 0
    writes: Written = "light and transmittance"

    @property
    def has_lattice(self) -> bool:
        """Whether there is a lattice beside the sky's."""
        return self.lattice != "none"

    @property
    def has_sky(self) -> bool:
        """Whether there is the sky's lattice."""
        return self.sky != "none"

    @property
    def is_reduced_medium(self) -> bool:
        """Whether the lattice holds light of reduced media."""
        return self.lattice == "reduced medium"


_NO_TWO_BANDS = "fn lattice_two_bands(p: vec3f, travel: vec3f) -> vec3f { return vec3f(0.0); }\n"


def slots(media: GpuMedia, variant: Variant) -> tuple[Slot, ...]:
    """The slots of the kernel."""
    made = [
        uniform("rays", RayParams),
        uniform("march", MarchParams),
        texture("picked", "2d", "unfilterable-float"),
        *media.medium_slots,
    ]
    if variant.sources:
        made += [storage("sources", SourceData), sampler("source_linear")]
        made += [texture(f"source{i}", "3d") for i in range(variant.sources)]
    names: list[str] = []
    if variant.has_lattice or variant.has_sky:
        made += [
            storage("lattices", LatticeParams),
            sampler("linear_clamp"),
            texture("march_cells", "3d", "uint"),
        ]
        colours = ("red", "green", "blue", "visibility_a", "visibility_b", "walls")
        names += [f"lattice_{name}" for name in colours]
    if variant.has_sky:
        names += [f"sky_{name}" for name in ("red", "green", "blue")]
    names += ["lattice_mean"] * (variant.lattice in ("mean", "reduced medium"))
    names += ["sky_mean"] * (variant.sky == "mean")
    names += ["sky_third"] * (variant.sky == "three bands")
    made += [texture(name, "3d") for name in names]
    beams = forward_slots() if variant.has_forward else ()
    beams += half_space_slots() if variant.half_space_side else ()
    return (*made, *beams)


def target_names(variant: Variant) -> list[str]:
    """The targets of the kernel, in their order."""
    light = ["scattered", *["skylit"] * variant.has_sky]
    return {
        "light and transmittance": [*light, "passed"],
        "light": light,
        "transmittance": ["passed"],
    }[variant.writes]


def at_once(variant: Variant, most: int) -> tuple[Variant, ...]:
    """One kernel, or two that share its targets where a pass may have but `most`."""
    if len(target_names(variant)) <= most or variant.writes != "light and transmittance":
        return (variant,)
    return replace(variant, writes="light"), replace(variant, writes="transmittance")


def firsts(variant: Variant) -> dict[str, tuple[str, ...]]:
    """Tables of which the first row alone is read, and what is not read of it."""
    has_table = variant.has_lattice or variant.has_sky
    return {"lattices": ("power_scale", "lookup_scale", "is_paper")} if has_table else {}


def _targets_wgsl(variant: Variant) -> str:
    """The struct of them, made of radiance (a: how far the ray goes), the sky's, transmittance."""
    names = target_names(variant)
    values = {"scattered": "scattered", "skylit": "vec4f(sky, 1.0)", "passed": "vec4f(T, 1.0)"}
    fields = "".join(f"    @location({i}) {n}: vec4f,\n" for i, n in enumerate(names))
    made = ", ".join(values[n] for n in names)
    return (
        f"struct Marched {{\n{fields}}}\nfn marched(scattered: vec4f, sky: vec3f, T: vec3f) "
        f"-> Marched {{ return Marched({made}); }}\n"
    )


def generated(variant: Variant) -> str:
    """The WGSL before the kernel."""
    lattice = _lattice_wgsl(variant) if variant.has_lattice or variant.has_sky else _NO_TWO_BANDS
    beams = FORWARD_WGSL if variant.has_forward else NO_FORWARD_WGSL
    half_space = NO_HALF_SPACE_WGSL
    if variant.half_space_side:
        half_space = half_space_wgsl(variant.half_space_side, has_forward=variant.has_forward)
    reduced = f"const IS_REDUCED_MEDIUM = {str(variant.is_reduced_medium).lower()};\n"
    return (
        _targets_wgsl(variant)
        + reduced
        + _sources_wgsl(variant)
        + lattice
        + _sky_wgsl(variant)
        + beams
        + half_space
    )


def _sources_wgsl(variant: Variant) -> str:
    """`emission_at`: the sum of all sources, unrolled, since textures cannot be indexed; and
    `step_share`: the length of a step from a point, in steps of the finest source.
    """
    sources, has_lattices = variant.sources, variant.has_lattice or variant.has_sky
    parts = ["    lattice_enter(p);\n"] if has_lattices else []
    parts += [
        f"    let uvw{i} = (sources[{i}].uvw_from_world * vec4f(p, 1.0)).xyz;\n"
        f"    if (all(uvw{i} >= vec3f(0.0)) && all(uvw{i} <= vec3f(1.0))) {{\n"
        f"        sum += textureSampleLevel(source{i}, source_linear, uvw{i}, 0.0).rgb\n"
        f"            * sources[{i}].scale * source_weight(sources[{i}].medium, p);\n    }}\n"
        for i in range(sources)
    ]
    lattices = ""
    if variant.has_lattice:
        lattices = "    sum += lattice_emission(p, travel);\n"
    if variant.has_lattice and variant.half_space_side:
        lattices += "    sum += half_space_emission(p, travel);\n"
    if not variant.is_reduced_medium:
        parts.append(lattices)
    uses = "//! use march_lattice\n" if has_lattices else "fn lattice_begin() {}\n"
    share = "march_step_share(p)" if has_lattices and not sources else "1.0"
    uses += f"fn step_share(p: vec3f) -> f32 {{ return {share}; }}\n"
    return (
        f"{uses}fn emission_at(p: vec3f, travel: vec3f) -> vec3f {{\n    var sum = vec3f(0.0);\n"
        + "".join(parts)
        + "    return sum;\n}\nfn reduced_emission_at(p: vec3f, travel: vec3f) -> vec3f {\n"
        + "    var sum = vec3f(0.0);\n"
        + lattices * variant.is_reduced_medium
        + "    return sum;\n}\n"
    )


def _lattice_wgsl(variant: Variant) -> str:
    """`lattice_emission`, `lattice_two_bands`, and how many lattices fade into each other."""
    count = f"const LATTICES_AT_ONCE = {min(variant.levels, MAX_LEVELS_AT_ONCE)}u;\n"
    if variant.is_reduced_medium:
        two_bands = _emission_wgsl("lattice").replace("fn lattice_emission", "fn lattice_two_bands")
        return count + _isotropic_wgsl("lattice") + two_bands
    return (
        count
        + _NO_TWO_BANDS
        + (_isotropic_wgsl("lattice") if variant.lattice == "mean" else _emission_wgsl("lattice"))
    )


def _sky_wgsl(variant: Variant) -> str:
    """`skylit_at`, after `emission_at` of the same point, and `sky_reduced_at`, after that."""
    if not variant.has_sky:
        return (
            "fn skylit_at(p: vec3f, travel: vec3f) -> vec3f { return vec3f(0.0); }\n"
            "fn sky_reduced_at() -> vec3f { return vec3f(0.0); }\n"
        )
    half_space = " + half_space_skylit(p, travel)" if variant.half_space_side else ""
    reduced = "vec3f(0.0)"
    if variant.is_reduced_medium:
        reduced = "sky_reduced_here()" + (
            " + half_space_sky_reduced()" if variant.half_space_side else ""
        )
    return (
        _third_wgsl(variant)
        + (_isotropic_wgsl("sky") if variant.sky == "mean" else _emission_wgsl("sky"))
        + f"fn sky_reduced_at() -> vec3f {{ return {reduced}; }}\n"
        + "fn skylit_at(p: vec3f, travel: vec3f) -> vec3f {\n"
        f"    return sky_emission(p, travel){half_space};\n}}\n"
    )


def _third_wgsl(variant: Variant) -> str:
    """`sky_third_at`: the third band per g^2, rgb."""
    if variant.sky != "three bands":
        return "fn sky_third_at(travel: vec3f) -> vec3f { return vec3f(0.0); }\n"
    return "//! use third_band\n"


def _emission_wgsl(name: str) -> str:
    """`{name}_emission`, W m^-3 sr^-1: the phase function keeps g of the two-band direction.

    Media whose single scattering comes with a source of its own do not scatter it.
    """
    samples = "".join(
        f"    let {c} = lattice_blended({name}_{c}, {str(name == 'lattice').lower()});\n"
        for c in ("red", "green", "blue")
    )
    third = "g.{0} * g.{0} * third.{0}, 0.0, 0.0, 0.0" if name == "sky" else "0.0"
    channels = ", ".join(
        f"lattice_radiance({c} + vec4f({third.format(c[0])}), along, own.{name}_direct * g.{c[0]})"
        for c in ("red", "green", "blue")
    )
    before = ""
    if name == "sky":
        samples += "    let third = sky_third_at(along);\n"
        samples += "    sky_means = max(vec3f(red.x, green.x, blue.x), vec3f(0.0));\n"
        before = _SKY_REDUCED
    return (
        f"{before}fn {name}_emission(p: vec3f, travel: vec3f) -> vec3f {{\n"
        "    if (lattice_at[0].w <= 0.0) { return vec3f(0.0); }\n"
        f"    let along = lattice_axes * travel;\n{samples}"
        "    var sum = vec3f(0.0);\n    for (var m = 0u; m < MEDIA_COUNT; m++) {\n"
        "        let g = media[m].g;\n"
        f"        sum += media_density_here[m] * media_lit_scattering[m] * vec3f({channels});\n"
        "    }\n"
        f"    return own.{name}_scale * sum;\n}}\n"
    )


_SKY_REDUCED = """
var<private> sky_means: vec3f;
// What the reduced media would scatter of the sky's light at the same point.
fn sky_reduced_here() -> vec3f {
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        sum += media_density_here[m] * media_reduced_sigma_s[m];
    }
    return own.sky_scale * select(vec3f(0.0), sum * sky_means, lattice_at[0].w > 0.0);
}
"""


def _isotropic_wgsl(name: str) -> str:
    """The same for isotropic phase functions: of the means of three channels."""
    return (
        f"fn {name}_emission(p: vec3f, travel: vec3f) -> vec3f {{\n"
        f"    let mean = lattice_blended({name}_mean, {str(name == 'lattice').lower()}).rgb;\n"
        "    var sum = vec3f(0.0);\n    for (var m = 0u; m < MEDIA_COUNT; m++) {\n"
        "        sum += media_density_here[m] * media_reduced_sigma_s[m];\n"
        f"    }}\n    return own.{name}_scale * select(vec3f(0.0), sum * max(mean, vec3f(0.0)), "
        "lattice_at[0].w > 0.0);\n}\n"
    )
