"""What a pass that reads media binds, and the WGSL that depends on how many there are."""

from __future__ import annotations

from ..gpu.layout import Struct, f32, mat4x4f, u32, vec3f
from ..gpu.rows import table
from ..gpu.slots import Slot, sampler, texture

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


def has_tree(count: int) -> bool:
    """Whether a tree of boxes finds which of so many media are met."""
    return count > LISTED_WHOLE


def room_for(count: int) -> int:
    """The number of media that shaders for `count` of them are made for.

    Of many the next power of two or three quarters of it, so that scenes with other numbers compile
    nothing again; the rows of their table beyond `count` are empty.
    """
    if not has_tree(count):
        return max(1, count)
    power = 1 << (count - 1).bit_length()
    return power if 4 * count > 3 * power else 3 * power // 4


LIST_BITS = 128
"""Media in a texel of a list of those on a path (`path_lists`)."""


def list_texels(count: int) -> int:
    """Texels of a list of so many media."""
    return -(-count // LIST_BITS)


def path_list_slots() -> tuple[Slot, ...]:
    """The slot of lists of media on paths."""
    return (texture("path_lists", "3d", "uint"),)


def path_list_wgsl(count: int, *, has_lists: bool) -> str:
    """The constants of `wgsl/path_lists.wgsl` for so many media, with lists or without."""
    # A walk along a list visits its media, after each texel of bits; one of the tree its nodes.
    texels = list_texels(count) if has_lists else 1
    visits = room_for(count) + texels if has_lists else _tree_nodes(count)
    return (
        f"const HAS_PATH_LISTS = {str(has_lists).lower()};\n"
        f"const MEDIA_VISITS = {visits}u;\nconst PATH_TEXELS = {texels}u;\n"
    )


def path_list_reads(*, has_lists: bool) -> str:
    """`path_list`, a texel of the lists."""
    read = "textureLoad(path_lists, at, 0)" if has_lists else "vec4u(0u)"
    return f"fn path_list(at: vec3u) -> vec4u {{ return {read}; }}\n"


def tree_wgsl(count: int) -> str:
    """The constants of `wgsl/media_tree.wgsl`."""
    return (
        f"const MEDIA_COUNT = {room_for(count)}u;\n"
        f"const HAS_MEDIA_TREE = {str(has_tree(count)).lower()};\n"
        f"const MEDIA_NODES = {_tree_nodes(count)}u;\n"
    )


def _tree_nodes(count: int) -> int:
    return 2 * room_for(count) - 1 if has_tree(count) else room_for(count)


def medium_slots(grids: int, *, has_detail: bool = False) -> tuple[Slot, ...]:
    """The slots of the table of media, of the density grids, and of their noise."""
    slots: list[Slot] = [table("media", MediumData)]
    # Without grids nothing is sampled: some devices bind few textures.
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
    # A texture that is not there cannot be bound; nothing is read instead.
    sample = "textureSampleLevel(medium_noise_texture, media_repeat, at, 0.0).x"
    noise = sample if has_detail else "0.0"
    density, size = _read("media_densities", grids)
    copied = 1 if has_tree(count) else room_for(count)
    # Of many grids shaders ask only whether there are several, and for a bound.
    bound = room_for(count) if has_tree(count) and grids > 1 else grids
    return (
        f"{tree_wgsl(count)}const GRID_COUNT = {bound}u;\nconst COPIED_MEDIA = {copied}u;\n"
        f"fn medium_noise(at: vec3f) -> f32 {{ return {noise}; }}\n"
        f"fn densities_texel(at: vec3f) -> vec2f {{ return {density}.xy; }}\n"
        f"fn densities_size() -> vec3f {{ return {size}; }}\n"
    )


def column_wgsl(grids: int, light_count: int, *, has_sized_lights: bool) -> str:
    """`light_columns_texel`: four lights' columns at texture coordinates; and its size.

    `has_sized_lights`: whether media may see a light as large as it is.
    """
    texel, size = _read("light_columns", grids)
    return (
        f"const HAS_SIZED_LIGHTS = {str(has_sized_lights).lower()};\n"
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
