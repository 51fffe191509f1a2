"""What each part of the lighting pass is compiled from: constants and generated WGSL."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from .shadow_rays import ShadowRays
from .slots import AFTER, GATHERED, MIRRORED, Attenuation, Gloss, Part

# Twins of what a pass may do without, so that one text serves all passes.
_NO_ATTENUATION = """
fn light_transmittance(index: u32, p: vec3f) -> vec3f { return vec3f(1.0); }
"""
_NOT_TRACED = """
fn arriving_share(lit: f32, p: vec3f, n: vec3f, in: Incoming) -> f32 { return lit; }
"""
_TRACED = "//! use traced_shadow\n"
_ATTENUATED_BY_MEDIA = """
//! use media_light
fn light_transmittance(index: u32, p: vec3f) -> vec3f {
    return media_light_transmittance(row_of_lights(index), index, p);
}
"""
# The same in a single box of a homogeneous medium, whose coefficients the triangle carries.
_ATTENUATED_BY_ONE_BOX = """
//! use media_light
fn light_transmittance(index: u32, p: vec3f) -> vec3f {
    let medium = first_media();
    let path = media_light_path(light_at(index), p);
    let o = (medium.volume_from_world * vec4f(p, 1.0)).xyz;
    let d = (medium.volume_from_world * vec4f(path.xyz, 0.0)).xyz;
    let span = ray_box_interval(o, d, vec3f(0.0), vec3f(1.0));
    return transmittance(medium.sigma_t, max(min(span.y, path.w) - max(span.x, 0.0), 0.0));
}
"""


_NO_PANES = """
fn panes_passed(light: LightData, p: vec3f, n: vec3f, in: Incoming) -> vec3f { return vec3f(1.0); }
"""

# Glossy pixels are left to `glossy_pixels`, with the rest of their light.
_SEPARATELY = """
fn is_traced_separately(r: Reflector, n_v: f32) -> bool {
    return glossy_share(specular_albedo(r, n_v), sqrt(r.alpha)) > 0.0;
}
"""
_INLINE = """
fn is_traced_separately(r: Reflector, n_v: f32) -> bool { return false; }
"""
# Pixels whose reflections another pass adds are listed with the light that they have.
_LISTED = """
//! use packed_pixel
fn list_glossy(pixel: vec2u, direct: vec3f, indirect: vec3f, share: f32) {
    let at = atomicAdd(&found[0], 1u);
    listed[2u * at] = vec4u(bitcast<vec3u>(direct), packed_pixel(pixel));
    listed[2u * at + 1u] = vec4u(bitcast<vec3u>(indirect), bitcast<u32>(share));
}
"""
_NOT_LISTED = """
fn list_glossy(pixel: vec2u, direct: vec3f, indirect: vec3f, share: f32) {}
"""
# Where lights were drawn by a pass before, the rest is added to that.
_LIT = """
fn lit_of(pixel: vec2u) -> vec4f { return textureLoad(lit, pixel, 0); }
"""
_NOT_LIT = """
fn lit_of(pixel: vec2u) -> vec4f { return vec4f(0.0); }
"""
# A stage binds sixteen textures at least: what a part does not draw is not in it.
_NO_LIGHTS = """
fn background(direction: vec3f) -> vec3f { return vec3f(0.0); }
fn direct_light(r: Reflector, p: vec3f, n: vec3f, v: vec3f) -> vec3f { return vec3f(0.0); }
"""
_NO_LATTICES = """
fn gathered(position: vec2f, d: f32, p: vec3f, r: Reflector, n: vec3f, v: vec3f) -> Gathered {
    return Gathered(vec3f(0.0), vec3f(0.0), 1.0, false);
}
"""


# What single lights and lattices are read from; nothing here goes from a light's view to the world,
# and all that is asked of media is their transmittance.
_MEDIA_FIRST = {
    "media": (
        "albedo",
        "g",
        "phase",
        "shafts",
        "voxel",
        "detail_periods",
        "detail",
        "detail_bias",
        "emission",
        "emission_first",
        "emission_count",
        "grid_first",
        "grid_count",
        "columns_first",
        "columns_count",
        "nodes",
    )
}
_LIGHTS_FIRST: dict[str, tuple[str, ...]] = {"lights": (), "parallel_views": ("world_from_clip",)}
LATTICES_FIRST: dict[str, tuple[str, ...]] = {"lattices": ()}


def _texels(names: tuple[str, ...]) -> str:
    """How a pixel of each of these textures is read."""
    return "".join(
        f"fn {name}_of(pixel: vec2u) -> vec4f {{ return textureLoad({name}, pixel, 0); }}\n"
        for name in names
    )


_NOT_MIRRORED = """
fn mirrored_light_of(pixel: vec2u) -> vec4f { return vec4f(0.0); }
fn mirrored_sky_of(pixel: vec2u) -> vec4f { return vec4f(0.0); }
"""


@dataclass(frozen=True)
class LightKinds:
    """The surfaces and lights of a scene.

    `has_surfaces`: without, every pixel is background. `has_directional`, `has_local`: the kinds of
    lights there may be; `is_one_directional`: the table `lights` has one row, a directional light.
    `has_panes`: translucent surfaces tint light. `shadows`: rays that decide where shadow maps are
    unsure, as far as the device binds what they need.
    """

    has_surfaces: bool = True
    has_directional: bool = True
    has_local: bool = True
    is_one_directional: bool = False
    has_panes: bool = False
    shadows: ShadowRays | None = None


@dataclass(frozen=True)
class LatticeLight:
    """How passes read the light of lattices and sky.

    `is_occluded`: near occluders shade it. `has_sky`: whether `sky_cube` may hold light.
    `is_one_lattice`: the table `lattices` has one row. `damping`, `has_interreflection`: see
    `Irradiance`; no pass but lighting asks.
    """

    is_occluded: bool = False
    has_sky: bool = True
    is_one_lattice: bool = False
    damping: float = 0.0
    has_interreflection: bool = False

    @property
    def constants(self) -> dict[str, float]:
        """For `wgsl/lattices_light.wgsl`."""
        return {
            "HAS_OCCLUSION": float(self.is_occluded),
            "HAS_SKY": float(self.has_sky),
            "IS_ONE_LATTICE": float(self.is_one_lattice),
        }


@dataclass(frozen=True)
class Kernel:
    """What one part of lighting is compiled from, besides its file."""

    generated: str
    constants: dict[str, float]
    firsts: dict[str, tuple[str, ...]]

    def __add__(self, other: Kernel) -> Kernel:
        return Kernel(
            self.generated + other.generated,
            self.constants | other.constants,
            self.firsts | other.firsts,
        )


def lattices_kernel(part: Part, light: LatticeLight, gloss: Gloss) -> Kernel:
    """The light of lattices and sky; nothing of it for the part "lights"."""
    if part == "lights":
        return Kernel(_NOT_LISTED + _NO_LATTICES, {"HAS_LATTICES": 0.0}, {})
    # Where the final gather has the light of surfaces, no lattice is read.
    if part == "gathered":
        mirrored = _texels(MIRRORED) if gloss == "traced" else _NOT_MIRRORED
        text = f"{_NOT_LISTED}{_texels(GATHERED)}{mirrored}//! use gathered_light\n"
        return Kernel(text, {"HAS_LATTICES": 1.0}, {})
    # Else the lattices from the finest outwards, with the sky and near surfaces.
    constants = {
        **light.constants,
        "HAS_LATTICES": 1.0,
        "HAS_GLOSS": float(gloss == "inline"),
        "DAMPING": light.damping,
        "RETURNED": float(light.has_interreflection),
        "HAS_NEAR_FIELD": float(part == "lattices"),
    }
    listing = _SEPARATELY + _LISTED if gloss == "listed" else _INLINE + _NOT_LISTED
    return Kernel(f"{listing}//! use lattices_light\n", constants, LATTICES_FIRST)


def lights_kernel(
    part: Part,
    kinds: LightKinds,
    attenuation: Attenuation | None,
    shadows: Mapping[str, float] | None = None,
) -> Kernel:
    """Lights, emission and background, or the texture where another part wrote them.

    `shadows`: the constants of `ShadowRays`, where rays look for them.
    """
    # Another part draws them, into the texture that this one reads.
    if part in AFTER:
        return Kernel(_LIT + _NO_LIGHTS, {"HAS_LIGHTS": 0.0}, {})
    is_box = attenuation is not None and attenuation.is_one_box
    # Kinds of lights that the scene lacks cost nothing: their loops are compiled out.
    constants = {
        "HAS_LIGHTS": 1.0,
        "HAS_DIRECTIONAL": float(kinds.has_directional),
        "HAS_LOCAL": float(kinds.has_local),
        "IS_ONE_DIRECTIONAL": float(kinds.is_one_directional),
    }
    # What stands between a light and a pixel: media, translucent surfaces, and rays where maps are
    # unsure.
    panes = "//! use panes\n" if kinds.has_panes else _NO_PANES
    constants |= shadows or {}
    traced = _NOT_TRACED if shadows is None else _TRACED
    asked = _transmittance_wgsl(attenuation) + panes + traced
    generated = _NOT_LIT + asked + "//! use direct_light\n"
    return Kernel(generated, constants, _LIGHTS_FIRST | _MEDIA_FIRST if is_box else _LIGHTS_FIRST)


def _transmittance_wgsl(attenuation: Attenuation | None) -> str:
    """What the media bind, and `light_transmittance`, which `direct_light` asks for."""
    if attenuation is None:
        return _NO_ATTENUATION
    # The coefficients of a single box come with the triangle, not from a table in each fragment.
    by = _ATTENUATED_BY_ONE_BOX if attenuation.is_one_box else _ATTENUATED_BY_MEDIA
    return attenuation.wgsl + by
