"""What a pass that reads media binds, and the WGSL that depends on how many there are."""

from __future__ import annotations

from ..gpu.layout import Struct, f32, mat4x4f, u32, vec3f
from ..gpu.slots import Slot, sampler, storage, texture

LISTED_WHOLE = 8
"""So many media are taken one by one; of more, a tree skips those that are not met."""


class MediumData(Struct):
    """One medium, as shaders see it; its box is 0..1 on each axis of its own space."""

    volume_from_world = mat4x4f()
    sigma_t = vec3f("m^-1 at density 1")
    kind = u32("0 box, 1 ellipsoid, 2 grid")
    albedo = vec3f()
    phase = u32("which of the mean cosines that media have")
    g = vec3f("mean cosine")
    shafts = u32("which lights' single scattering shafts draw: 0 none, 1 all, 2 local lights")
    voxel = f32("m, the grid's shortest cell side; 0 without a grid")
    detail_periods = vec3f("of the noise along the box's sides")
    detail = f32("how strong the noise is")
    detail_bias = f32("keeps the mean density")
    emission = vec3f("W m^-3 sr^-1 of the brightest voxel, or at density 1")
    emission_first = vec3f("texels, of its grid in the texture of all")
    emission_count = vec3f("texels; 0 where it emits by its density")
    grid_first = vec3f("texels, of its grid in the texture of all")
    grid_count = vec3f("texels")
    columns_first = vec3f("texels, of its columns in the texture of all")
    columns_count = vec3f("texels for four lights")
    nodes = mat4x4f("two nodes of the tree: (low, after), (high, medium), twice; m")


def medium_slots(grids: int, *, has_detail: bool = False) -> tuple[Slot, ...]:
    """The slots of the table of media, of the density grids, and of their noise."""
    slots: list[Slot] = [storage("media", MediumData)]
    if grids:
        slots += [sampler("media_linear"), texture("media_densities", "3d")]
    if has_detail:
        slots += [sampler("media_repeat"), texture("medium_noise_texture", "3d")]
    return tuple(slots)


def column_slots(grids: int) -> tuple[Slot, ...]:
    """The slots of the columns of the grids towards the lights."""
    return (texture("light_columns", "3d"),) if grids else ()


def medium_wgsl(count: int, grids: int, *, has_detail: bool = False) -> str:
    """The constants, `densities_texel`, `densities_size` and `medium_noise`."""
    sample = "textureSampleLevel(medium_noise_texture, media_repeat, at, 0.0).x"
    noise = sample if has_detail else "0.0"
    density, size = _read("media_densities", grids)
    has_tree = count > LISTED_WHOLE
    nodes = 2 * count - 1 if has_tree else max(1, count)
    return (
        f"const MEDIA_COUNT = {max(1, count)}u;\nconst GRID_COUNT = {grids}u;\n"
        f"const HAS_MEDIA_TREE = {str(has_tree).lower()};\nconst MEDIA_NODES = {nodes}u;\n"
        f"const COPIED_MEDIA = {1 if has_tree else max(1, count)}u;\n"
        f"fn medium_noise(at: vec3f) -> f32 {{ return {noise}; }}\n"
        f"fn densities_texel(at: vec3f) -> vec2f {{ return {density}.xy; }}\n"
        f"fn densities_size() -> vec3f {{ return {size}; }}\n"
    )


def column_wgsl(grids: int, light_count: int) -> str:
    """`light_columns_texel`: four lights' columns at texture coordinates; and its size."""
    texel, size = _read("light_columns", grids)
    return (
        f"const LIGHT_GROUPS = {light_groups(light_count)}.0;\n"
        f"fn light_columns_texel(at: vec3f) -> vec4f {{ return {texel}; }}\n"
        f"fn light_columns_size() -> vec3f {{ return {size}; }}\n"
    )


def emission_slots(*, has_grids: bool) -> tuple[Slot, ...]:
    """The slot of the emission grids of all media."""
    return (texture("emission_grids", "3d"),) if has_grids else ()


def emission_wgsl(*, has_emission: bool, has_grids: bool) -> str:
    """HAS_EMISSION, and `media_emission_texel`, at texels of the texture of all emission grids."""
    size = "vec3f(textureDimensions(emission_grids))"
    sample = f"textureSampleLevel(emission_grids, media_linear, at / {size}, 0.0).rgb"
    texel = sample if has_grids else "vec3f(0.0)"
    return (
        f"const HAS_EMISSION = {str(has_emission).lower()};\n"
        f"fn media_emission_texel(at: vec3f) -> vec3f {{ return {texel}; }}\n"
    )


def light_groups(light_count: int) -> int:
    """Slabs of four lights."""
    return max(1, -(-light_count // 4))


def _read(name: str, grids: int) -> tuple[str, str]:
    """A texel of a texture at `at`, and its size; without grids there is none."""
    if not grids:
        return "vec4f(0.0)", "vec3f(1.0)"
    texel = f"textureSampleLevel({name}, media_linear, at, 0.0)"
    return texel, f"vec3f(textureDimensions({name}))"
