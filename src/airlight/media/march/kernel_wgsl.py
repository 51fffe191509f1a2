"""The functions in which variants of the marching kernel differ, as generated WGSL.

    marched                              the targets, from what the loop summed
    emission_at, reduced_emission_at     sources and the lattice, per medium
    skylit_at, sky_reduced_at            the sky's lattice
    forward_light, half_space_emission   from libraries, or their `no_` twins

`march.wgsl` calls them; `tests/media/test_march_kernel.py` compares what variants draw.
"""

from __future__ import annotations

from ...fields import ABSOLUTE, ALL_MEDIA, SOME_MEDIA
from .forward_source import FORWARD_WGSL, NO_FORWARD_WGSL
from .half_space import NO_HALF_SPACE_WGSL, half_space_wgsl
from .kernel import MAX_LEVELS_AT_ONCE, Variant, target_names

# What stands in where there is no lattice, or its two bands are not read.
_NO_LATTICES = "fn lattice_begin() {}\nfn lattice_obliqueness(n: vec3f) -> f32 { return 0.0; }\n"
_NO_TWO_BANDS = "fn lattice_two_bands(p: vec3f, travel: vec3f) -> vec3f { return vec3f(0.0); }\n"


def _over_media(term: str) -> str:
    """`sum`: over the media at a point, of row m and mean cosines g, density times `term`."""
    return (
        "    var sum = vec3f(0.0);\n    for (var j = 0u; j < media_here(); j++) {\n"
        "        let k = medium_here(j);\n        let m = ray_medium(k);\n"
        "        let g = row_of_media(m).g;\n"
        f"        sum += media_density_here[k] * {term};\n    }}\n"
    )


def _targets_wgsl(variant: Variant) -> str:
    """The struct of them, made of radiance (a: how far the ray goes), the sky's, transmittance."""
    # The loop sums all; what has no target is left out by the compiler.
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
    # A library for each field that there is, a twin that returns nothing for the others.
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


def emission_wgsl(variant: Variant) -> str:
    """`emission_at` of a `variant` whose lattice, if there is one, is read as means or lobes."""
    lattice = _isotropic_wgsl("lattice") if variant.has_lattice else ""
    if variant.lattice == "lobes":
        lattice = _LOBES_WGSL
    count = f"const LATTICES_AT_ONCE = {min(variant.levels, MAX_LEVELS_AT_ONCE)}u;\n"
    return _sources_wgsl(variant) + count + lattice


def _sources_wgsl(variant: Variant) -> str:
    """`emission_at`: the sum of all sources, unrolled, since textures cannot be indexed; and
    `step_share`: the length of a step from a point, in steps of the finest source.
    """
    # Textures of emission one by one, then the lattice, whole or through the reduced media.
    sources, has_lattices = variant.sources, variant.has_lattice or variant.has_sky
    parts = ["    lattice_enter(p);\n"] if has_lattices else []
    parts += ["    var left = 1.0;\n"] if any(variant.fading) else []
    parts += [_source_wgsl(i, variant.fading) for i in range(sources)]
    # Lattices hold the light of the true medium or of the reduced one.
    lattices = ""
    if variant.has_lattice:
        lattices = "    sum += lattice_emission(p, travel);\n"
    if variant.has_lattice and variant.half_space_side:
        lattices += "    sum += half_space_emission(p, travel);\n"
    # What the reduced medium scatters reaches the eye through it, so it is summed apart.
    is_reduced = variant.lattice == "reduced medium"
    if not is_reduced:
        parts.append(lattices)
    # Libraries of what is there alone, because each costs time to compile.
    uses = "//! use march_lattice\n" if has_lattices else _NO_LATTICES
    uses += _WEIGHT_WGSL if sources else ""
    uses += _step_share_wgsl(variant)
    return (
        f"{uses}fn emission_at(p: vec3f, travel: vec3f) -> vec3f {{\n    var sum = vec3f(0.0);\n"
        + "".join(parts)
        + "    return sum;\n}\nfn reduced_emission_at(p: vec3f, travel: vec3f) -> vec3f {\n"
        + "    var sum = vec3f(0.0);\n"
        + lattices * is_reduced
        + "    return sum;\n}\n"
    )


def _source_wgsl(i: int, fading: tuple[bool, ...]) -> str:
    """The light of one source; nested grids add their shares of what finer ones leave."""
    # The finest of nested grids has all light to give, each next one what those left.
    is_finer, is_next = any(fading[i : i + 1]), i > 0 and any(fading[i - 1 : i])
    begin = "    left = 1.0;\n" if is_finer and not is_next else ""
    share = f"        let share = left * source_share({i}u, uvw{i});\n        left -= share;\n"
    factor = "share * " if is_finer else "left * " if is_next else ""
    return (
        f"{begin}    let uvw{i} = (sources[{i}].uvw_from_world * vec4f(p, 1.0)).xyz;\n"
        f"    if (all(uvw{i} >= vec3f(0.0)) && all(uvw{i} <= vec3f(1.0))) {{\n{share * is_finer}"
        f"        sum += {factor}textureSampleLevel(source{i}, source_linear, uvw{i}, 0.0).rgb\n"
        f"            * sources[{i}].scale\n"
        f"            * weight_of_source({i}u);\n    }}\n"
    )


_WEIGHT_WGSL = f"""
//! use source_weight
const ABSOLUTE = {ABSOLUTE};
const ALL_MEDIA = {ALL_MEDIA};
const SOME_MEDIA = {SOME_MEDIA};
"""

_FADING_WGSL = """
// The share of a finer grid's light at a point of its box; see lattice.nested.shares.
fn source_share(i: u32, uvw: vec3f) -> f32 {
    let low = (uvw - sources[i].fade_low) / sources[i].fade_low_width;
    let high = (sources[i].fade_high - uvw) / sources[i].fade_high_width;
    let nearer = min(low, high);
    return saturate(min(nearer.x, min(nearer.y, nearer.z)));
}
"""


def _step_share_wgsl(variant: Variant) -> str:
    """`step_share`: steps are as long as the cells of the finest source, or lattice, there."""
    # Without nested grids one length suits all steps, but for those of a lattice's levels.
    has_lattices = variant.has_lattice or variant.has_sky
    if not any(variant.fading) or has_lattices:
        share = "march_step_share(p)" if has_lattices and not variant.sources else "1.0"
        fading = _FADING_WGSL if any(variant.fading) else ""
        return f"{fading}fn step_share(p: vec3f) -> f32 {{ return {share}; }}\n"
    # The finest grid around a point says how long its step may be, outside of all the coarsest.
    return (
        f"{_FADING_WGSL}fn step_share(p: vec3f) -> f32 {{\n    var share = 1e9;\n"
        f"    var longest = 1.0;\n    for (var i = 0u; i < {variant.sources}u; i++) {{\n"
        "        let uvw = (sources[i].uvw_from_world * vec4f(p, 1.0)).xyz;\n"
        "        longest = max(longest, sources[i].steps);\n"
        "        if (all(uvw >= vec3f(0.0)) && all(uvw <= vec3f(1.0))) {\n"
        "            share = min(share, sources[i].steps);\n        }\n    }\n"
        "    return min(share, longest);\n}\n"
    )


def _lattice_wgsl(variant: Variant) -> str:
    """`lattice_emission`, `lattice_two_bands`, and how many lattices fade into each other."""
    count = f"const LATTICES_AT_ONCE = {min(variant.levels, MAX_LEVELS_AT_ONCE)}u;\n"
    # Means that the reduced media scatter, and two bands for what media themselves transmit.
    if variant.lattice == "reduced medium":
        two_bands = _emission_wgsl("lattice").replace("fn lattice_emission", "fn lattice_two_bands")
        return count + _isotropic_wgsl("lattice") + two_bands
    emission = {
        "mean": _isotropic_wgsl("lattice"),
        "in-scattering": _IN_SCATTERING_WGSL,
    }
    return count + _NO_TWO_BANDS + emission.get(variant.lattice, _emission_wgsl("lattice"))


def _sky_wgsl(variant: Variant) -> str:
    """`skylit_at`, after `emission_at` of the same point, and `sky_reduced_at`, after that."""
    if not variant.has_sky:
        return (
            "fn skylit_at(p: vec3f, travel: vec3f) -> vec3f { return vec3f(0.0); }\n"
            "fn sky_reduced_at() -> vec3f { return vec3f(0.0); }\n"
        )
    # Beyond the lattices an endless medium has light of the sky of its own.
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
    # Two bands of each channel, and the third of the sky, seen along the ray.
    samples = "".join(
        f"    let {c} = lattice_blended({name}_{c}, {str(name == 'lattice').lower()});\n"
        for c in ("red", "green", "blue")
    )
    third = "g.{0} * g.{0} * third.{0}, 0.0, 0.0, 0.0" if name == "sky" else "0.0"
    # The phase function in the same bands: of direct light each medium keeps g.
    channels = ", ".join(
        f"lattice_radiance({c} + vec4f({third.format(c[0])}), along, own.{name}_direct * g.{c[0]})"
        for c in ("red", "green", "blue")
    )
    # The sky may have a third band, and leaves means for what the reduced medium scatters.
    before = ""
    if name == "sky":
        samples += "    let third = sky_third_at(along);\n"
        samples += "    sky_means = max(vec3f(red.x, green.x, blue.x), vec3f(0.0));\n"
        before = _SKY_REDUCED
    return (
        f"{before}fn {name}_emission(p: vec3f, travel: vec3f) -> vec3f {{\n"
        "    if (lattice_at[0].w <= 0.0) { return vec3f(0.0); }\n"
        f"    let along = lattice_axes * travel;\n{samples}"
        + _over_media(f"lit_scattering_of(m) * vec3f({channels})")
        + f"    return own.{name}_scale * sum;\n}}\n"
    )


_SKY_REDUCED = f"""
var<private> sky_means: vec3f;
// What the reduced media would scatter of the sky's light at the same point.
fn sky_reduced_here() -> vec3f {{
{_over_media("reduced_sigma_s_of(m)")}
    return own.sky_scale * select(vec3f(0.0), sum * sky_means, lattice_at[0].w > 0.0);
}}
"""


_IN_SCATTERING_WGSL = f"""
//! use air_lobes
// What media scatter towards the eye, as cells have it from their middles, turned to the ray's way.
fn lattice_emission(p: vec3f, travel: vec3f) -> vec3f {{
    if (lattice_at[0].w <= 0.0) {{ return vec3f(0.0); }}
    let seen = max(lattice_blended(lattice_mean, true).rgb, vec3f(0.0));
    let flow = lattice_blended(lobe_scattered_along, true);
    let to_eye = rays.eye - lattices[0].cell * march_step_share(p) * own.ahead - p;
    let given = to_eye / max(length(to_eye), 1e-6);
{_over_media("lit_scattering_of(m) * turned_lobe(flow, travel, given, g)")}
    return own.lattice_scale * sum * seen;
}}
"""

_TWO_LOBES = """lit_scattering_of(m) * (scattered_lobe(straight, along, travel, g)
            + scattered_lobe(all - straight, scattered_along, travel, g))"""
_LOBES_WGSL = f"""
//! use air_lobes
// What media scatter of unscattered light and of all other, each of which goes about one way.
fn lattice_emission(p: vec3f, travel: vec3f) -> vec3f {{
    if (lattice_at[0].w <= 0.0) {{ return vec3f(0.0); }}
    let all = lattice_blended(lattice_mean, true).rgb;
    let straight = lattice_blended(lobe_straight, true).rgb;
    let along = lattice_blended(lobe_along, true).rgb;
    let scattered_along = lattice_blended(lobe_scattered_along, true).rgb;
{_over_media(_TWO_LOBES)}
    return own.lattice_scale * sum;
}}
"""


def _isotropic_wgsl(name: str) -> str:
    """The same for isotropic phase functions, or light that has been through them: of the means of
    three channels."""
    # The mean is scattered into all directions alike; beyond the lattices there is none.
    return (
        f"fn {name}_emission(p: vec3f, travel: vec3f) -> vec3f {{\n"
        f"    let mean = lattice_blended({name}_mean, {str(name == 'lattice').lower()}).rgb;\n"
        + _over_media("reduced_sigma_s_of(m)")
        + f"    return own.{name}_scale * select(vec3f(0.0), sum * max(mean, vec3f(0.0)), "
        "lattice_at[0].w > 0.0);\n}\n"
    )
