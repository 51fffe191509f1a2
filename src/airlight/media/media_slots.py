"""What a pass that reads media binds, and the WGSL that depends on how many there are."""

from __future__ import annotations

from ..gpu.layout import Struct, f32, mat4x4f, u32, vec3f
from ..gpu.slots import Slot, sampler, storage, texture


class MediumData(Struct):
    """One medium, as shaders see it; its box is 0..1 on each axis of its own space."""

    volume_from_world = mat4x4f()
    sigma_t = vec3f("m^-1 at density 1")
    kind = u32("0 box, 1 ellipsoid, 2 grid")
    albedo = vec3f()
    grid = u32("which density texture")
    g = vec3f("mean cosine")
    has_shafts = u32("1: its single scattering is drawn by shafts")
    voxel = f32("m, the grid's shortest cell side; 0 without a grid")
    detail_periods = vec3f("of the noise along the box's sides")
    detail = f32("how strong the noise is")
    detail_bias = f32("keeps the mean density")
    emission = vec3f("W m^-3 sr^-1 of the brightest voxel, or at density 1")
    emission_first = vec3f("texels, of its grid in the texture of all")
    emission_count = vec3f("texels; 0 where it emits by its density")


def medium_slots(grids: int, *, has_detail: bool = False) -> tuple[Slot, ...]:
    """The slots of the table of media, of the density grids, and of their noise."""
    slots: list[Slot] = [storage("media", MediumData)]
    if grids:
        slots.append(sampler("media_linear"))
        slots += [texture(f"medium_density{i}", "3d") for i in range(grids)]
    if has_detail:
        slots += [sampler("media_repeat"), texture("medium_noise_texture", "3d")]
    return tuple(slots)


def column_slots(grids: int) -> tuple[Slot, ...]:
    """The slots of the columns of each grid towards the lights."""
    return tuple(texture(f"light_columns{i}", "3d") for i in range(grids))


def medium_wgsl(count: int, grids: int, *, has_detail: bool = False) -> str:
    """The constants, `medium_grid_texel` (a grid's density in its x) and `medium_noise`."""
    sample = "textureSampleLevel(medium_noise_texture, media_repeat, at, 0.0).x"
    noise = sample if has_detail else "0.0"
    return (
        f"const MEDIA_COUNT = {max(1, count)}u;\nconst GRID_COUNT = {grids}u;\n"
        f"fn medium_noise(at: vec3f) -> f32 {{ return {noise}; }}\n"
        + _chosen(
            "medium_grid_texel",
            "uvw: vec3f",
            "vec4f",
            "vec4f(0.0)",
            [_sample(f"medium_density{i}") for i in range(grids)],
        )
    )


def column_wgsl(grids: int, light_count: int) -> str:
    """`light_columns_texel`: four lights' columns at texture coordinates; and its size."""
    return (
        f"const LIGHT_GROUPS = {light_groups(light_count)}u;\n"
        + _chosen(
            "light_columns_texel",
            "uvw: vec3f",
            "vec4f",
            "vec4f(0.0)",
            [_sample(f"light_columns{i}") for i in range(grids)],
        )
        + _chosen(
            "light_columns_size",
            "",
            "vec3u",
            "vec3u(1u)",
            [f"textureDimensions(light_columns{i})" for i in range(grids)],
        )
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


def _sample(name: str) -> str:
    return f"textureSampleLevel({name}, media_linear, uvw, 0.0)"


def _chosen(name: str, argument: str, result: str, default: str, choices: list[str]) -> str:
    """A function that picks by grid: WGSL cannot index textures."""
    arguments = f"grid: u32, {argument}" if argument else "grid: u32"
    cases = "".join(f"        case {i}u: {{ return {c}; }}\n" for i, c in enumerate(choices))
    return (
        f"fn {name}({arguments}) -> {result} {{\n    switch grid {{\n{cases}"
        f"        default: {{ return {default}; }}\n    }}\n}}\n"
    )
