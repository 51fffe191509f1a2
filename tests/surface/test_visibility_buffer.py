"""Surfaces of the triangles that pixels see, beside the same ones as they are rasterised."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.maths.colour import srgb_decode
from airlight.maths.transforms import clip_from_view_infinite, view_from_world
from airlight.scene import DirectionalLight, Material, Mesh, Scene, SpotLight, Texture
from airlight.surface.gbuffer import GBuffer
from airlight.surface.geometry import GpuScene
from airlight.surface.light_views import light_views
from airlight.surface.packed_maps import most_texels, uses_visibility_buffer
from airlight.surface.reflective import ReflectiveShadowMaps
from airlight.surface.textures import mip_chain
from airlight.surface.triangle_table import most_triangles

SIZE = (48, 32)
GBUFFER, REFLECTIVE = "airlight.surface.gbuffer", "airlight.surface.reflective"
RNG = np.random.default_rng(11)
UVS = np.array([[-0.3, 1.4], [1.7, 1.1], [1.3, 0.2], [0.1, -0.6]], np.float32)


def _shifted(x, y, z):
    """World from object of a shift, metres."""
    made = np.eye(4)
    made[:3, 3] = (x, y, z)
    return made


def _map(side=16, **how):
    """A smooth image, so that filters that round differ by little."""
    x, y = np.meshgrid(*2 * [np.arange(side) * 2 * np.pi / side])
    waves = [np.sin(x + a) * np.cos(y + b) for a, b in RNG.uniform(0, 6, (4, 2))]
    pixels = np.round(150 + 80 * np.stack(waves, axis=-1)).astype(np.uint8)
    pixels[..., 2] = 250 if not how.get("is_srgb", True) else pixels[..., 2]
    return Texture(pixels, **how)


def _painted(wrap="repeat", **how):
    kinds = {
        "base_color_texture": _map(wrap=(wrap, wrap)),
        "normal_texture": _map(wrap=(wrap, wrap), is_srgb=False),
        "metallic_roughness_texture": _map(wrap=(wrap, wrap), is_srgb=False),
    }
    return Material(base_color=(0.8, 0.7, 0.6), metallic=0.0, roughness=0.7, **{**kinds, **how})


def _placed(**how):
    maps = _painted()
    scaled = {
        f"{n}_texture": replace(getattr(maps, f"{n}_texture"), scale=(0.5, 1.5), offset=(0.1, 0.3))
        for n in ("base_color", "normal", "metallic_roughness")
    }
    return replace(maps, **scaled)


CASES = {
    "plain": [
        Material(base_color=(0.2, 0.5, 0.7), metallic=0.3, roughness=0.4, emission=(3.0, 2.0, 1.0))
    ],
    "maps": [_painted()],
    "mirrored and clamped": [_painted("mirror"), _painted("clamp")],
    "placed": [_placed()],
    "holes": [_painted(alpha_cutoff=0.6), _painted()],
    "maps of light come after": [
        _painted(emission=(1.0, 1.0, 1.0), emission_texture=_map()),
        _painted(),
    ],
}


def _drawn(gpu, commands, scene, meshes, eye):
    found = {}
    for is_visible in (True, False):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(f"{GBUFFER}.uses_visibility_buffer", lambda gpu, v=is_visible: v)
            g = GBuffer(gpu, SIZE)
        on_device = GpuScene(gpu, scene)
        clip = clip_from_view_infinite(1.2, SIZE[0] / SIZE[1], 0.01)
        clip = clip @ view_from_world(eye, -np.asarray(eye), (0, 1, 0))
        g.encode(commands, on_device, clip)
        on_device.move(meshes)
        g.encode(commands, on_device, clip)
        commands.submit()
        textures = (g.depth, g.albedo, g.normal, g.emission)
        found[is_visible] = [t.read().astype(np.float64) for t in textures]
    return found[True], found[False]


def _lit(gpu, commands, scene, light):
    """Depth, normal and flux of a light's maps, both ways."""
    found = []
    on_device = GpuScene(gpu, scene)
    views = light_views([light], *on_device.bounds, 64)
    for is_visible in (True, False):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(f"{REFLECTIVE}.uses_visibility_buffer", lambda gpu, v=is_visible: v)
            maps = ReflectiveShadowMaps(gpu, "maps", 64, len(views))
        maps.encode(commands, on_device, [light], views)
        commands.submit()
        found.append([t.read().astype(np.float64) for t in (maps.depth, maps.normal, maps.flux)])
    return found


def assert_alike(flux, other):
    """Flux of maps in blocks of 8 x 8 texels, as cells see them.

    The visibility buffer's texel has the nearest texel of its material's maps, which are noise
    here, where rasterised ones are filtered.
    """
    texels = np.abs(flux - other)[other.any(axis=-1)]
    blocks = [f.reshape(8, 8, 8, 8, -1).mean(axis=(1, 3)) for f in (flux, other)]
    most = other.max()
    # Measured: .0025 of the sum, .009 of the most in a block, .023 root mean square.
    np.testing.assert_allclose(flux.sum(), other.sum(), rtol=0.005)
    np.testing.assert_allclose(blocks[0], blocks[1], atol=0.015 * most)
    assert np.sqrt(np.mean(texels**2)) < 0.03 * most


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("eye", [(0.4, 0.9, 2.2), (-0.7, 0.5, -2.0)])
def test_both_ways_see_the_same(gpu, commands, square, case, eye):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    meshes = [
        square((0.5 * k, 0, -0.4 * k), (1, 0.1, 0.2), (0.1, 1, -0.3), m, uvs=UVS)
        for k, m in enumerate(CASES[case])
    ]
    flat = np.diag([-0.8, 0.5, 0.7, 1.0])  # mirrored, too
    meshes += [replace(meshes[0], world_from_object=_shifted(-1, 0.3, 0.2) @ flat)]
    moved = tuple(
        replace(m, world_from_object=_shifted(0.1, 0.05, 0.0) @ m.world_from_object) for m in meshes
    )
    ours, plain = _drawn(gpu, commands, Scene(meshes=tuple(meshes)), moved, eye)
    np.testing.assert_array_equal(ours[0] > 0.0, plain[0] > 0.0)
    np.testing.assert_array_equal(ours[0], plain[0])
    assert (plain[0] > 0.0).mean() > 0.2
    # The driver filters in bytes: a normal map's byte is worth 1/127, more where its z is small.
    for texture, most, rms in ((1, 0.02, 1.5e-3), (2, 0.03, 2.5e-3), (3, 1e-3, 1e-3)):
        off = np.abs(ours[texture] - plain[texture])
        assert off.max() < 2.0 * most  # where rounding decides how many probes there are
        assert (off > most).mean() < 1e-3
        assert np.sqrt(np.mean((ours[texture] - plain[texture]) ** 2)) < rms


@pytest.mark.parametrize(
    "light",
    [
        DirectionalLight((0.2, -0.3, -1.0), (3.0, 2.0, 1.0)),
        SpotLight(
            (0.2, 0.5, 2.5), (-0.1, -0.2, -1.0), (5.0, 4.0, 3.0), inner_deg=20.0, outer_deg=40.0
        ),
    ],
)
@pytest.mark.parametrize("case", ["maps", "holes", "maps of light come after"])
def test_lights_see_the_same_both_ways(gpu, commands, square, case, light):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    meshes = tuple(
        square((0.5 * k, 0, -0.4 * k), (1, 0.1, 0.2), (0.1, 1, -0.3), m, uvs=UVS)
        for k, m in enumerate(CASES[case])
    )
    ours, plain = _lit(gpu, commands, Scene(meshes=meshes), light)
    (depth, normal, flux), (depth_0, normal_0, flux_0) = ours, plain
    np.testing.assert_array_equal(depth, depth_0)
    np.testing.assert_allclose(normal, normal_0, atol=2e-3)
    assert flux_0.max() > 0.5
    assert_alike(flux, flux_0)


def test_vertices_that_move_are_found_where_they_went(gpu, commands, square):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    still = square((0, 0, 0), (1, 0.1, 0.2), (0.1, 1, -0.3), _painted(), uvs=UVS)
    g = still.geometry
    bent = replace(
        g, positions=g.positions + np.float32([[0.2, 0, 0], [0, 0.3, 0], [0, 0, 0.2], [0, 0, 0]])
    )
    moved = Mesh(geometry=bent, material=still.material)
    ours, plain = _drawn(gpu, commands, Scene(meshes=(still,)), (moved,), (0.4, 0.9, 2.2))
    np.testing.assert_array_equal(ours[0], plain[0])
    np.testing.assert_allclose(ours[1], plain[1], atol=0.016)


@pytest.mark.parametrize("fitting", [0, 1])
def test_maps_that_do_not_fit_are_drawn_as_they_come(gpu, commands, square, monkeypatch, fitting):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    texels = 16 * 16 * 4 // 3 + 8  # of a map, its levels and their table
    limit = "airlight.surface.textures.most_texels"
    monkeypatch.setattr(limit, lambda gpu: fitting * texels + 2)
    materials = [_painted(), _painted(), Material(base_color=(0.2, 0.5, 0.7))]
    meshes = tuple(
        square((0.5 * k, 0, -0.4 * k), (1, 0.1, 0.2), (0.1, 1, -0.3), m, uvs=UVS)
        for k, m in enumerate(materials)
    )
    scene = GpuScene(gpu, Scene(meshes=meshes))
    shown = [scene.triangle_table.shows(draw.base_vertex, draw.material) for draw in scene.draws]
    assert sum(shown) == 1 + fitting
    ours, plain = _drawn(gpu, commands, Scene(meshes=meshes), meshes, (0.4, 0.9, 2.2))
    np.testing.assert_array_equal(ours[0], plain[0])
    assert np.sqrt(np.mean((ours[1] - plain[1]) ** 2)) < 4e-3


def test_a_map_larger_than_what_a_device_binds_is_drawn(gpu, commands, square, monkeypatch):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    monkeypatch.setitem(gpu.limits, "max-storage-buffer-binding-size", 64 * 64 * 8)
    assert most_texels(gpu) == 64 * 64
    large = Material(base_color_texture=Texture(np.full((64, 64, 4), 255, np.uint8)))
    mesh = square((0, 0, 0), (1, 0, 0), (0, 1, 0), large, uvs=UVS)
    ours, plain = _drawn(gpu, commands, Scene(meshes=(mesh,)), (mesh,), (0, 0, 2.0))
    assert plain[1][..., 0].max() > 0.79
    np.testing.assert_array_equal(ours[1], plain[1])


@pytest.mark.parametrize("triangles", [1, 2, 3, 4])
def test_triangles_that_do_not_fit_are_drawn_as_they_come(
    gpu, commands, square, monkeypatch, triangles
):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    limit = "airlight.surface.triangle_table.most_triangles"
    monkeypatch.setattr(limit, lambda gpu: triangles)
    meshes = tuple(
        square((0.5 * k, 0, -0.4 * k), (1, 0.1, 0.2), (0.1, 1, -0.3), _painted(), uvs=UVS)
        for k in range(2)
    )
    scene = GpuScene(gpu, Scene(meshes=meshes))
    assert (
        sum(scene.triangle_table.shows(d.base_vertex, d.material) for d in scene.draws)
        == triangles // 2
    )
    assert scene.triangle_table.shared.triangles.nbytes == max(16, triangles // 2 * 2 * 80)
    bent = tuple(
        replace(m, geometry=replace(m.geometry, positions=m.geometry.positions + np.float32(0.1)))
        for m in meshes
    )
    ours, plain = _drawn(gpu, commands, Scene(meshes=meshes), bent, (0.4, 0.9, 2.2))
    np.testing.assert_array_equal(ours[0], plain[0])
    for ours_one, plain_one in zip(ours[1:], plain[1:], strict=True):
        assert np.sqrt(np.mean((ours_one - plain_one) ** 2)) < 0.03
    light = DirectionalLight((0.2, -0.3, -1.0), (3.0, 2.0, 1.0))
    (depth, _, flux), (depth_0, _, flux_0) = _lit(gpu, commands, Scene(meshes=meshes), light)
    np.testing.assert_array_equal(depth, depth_0)
    assert_alike(flux, flux_0)


def test_a_scene_of_more_triangles_than_a_device_binds_is_drawn(gpu, commands, square, monkeypatch):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    grey = Material()
    meshes = tuple(square((k, 0, 0), (0.4, 0, 0), (0, 0.4, 0), grey) for k in range(40))
    bound = 60 * 80 + 8
    monkeypatch.setitem(gpu.limits, "max-storage-buffer-binding-size", bound)
    assert most_triangles(gpu) == 60
    ours, plain = _drawn(gpu, commands, Scene(meshes=meshes), meshes, (0, 0, 20.0))
    np.testing.assert_array_equal(ours[0], plain[0])
    np.testing.assert_array_equal(ours[1], plain[1])


_COLORS = np.full((4, 4), 0.5, np.float32)
KINDS = {
    "plain": (Material(base_color=(0.1, 0.2, 0.9)), {}),
    "other": (Material(base_color=(0.9, 0.2, 0.1)), {}),
    "glowing": (
        Material(base_color=(0.1, 0.9, 0.1), emission=(1, 1, 1), emission_texture=_map()),
        {},
    ),
    "coloured": (Material(base_color=(0.9, 0.9, 0.1)), {"colors": _COLORS}),
    "holed": (_painted(alpha_cutoff=0.6), {}),
    "one-sided": (Material(base_color=(0.1, 0.9, 0.9), two_sided=False), {}),
}


@pytest.mark.parametrize("depth_first_px", [0.0, 1e9])
@pytest.mark.parametrize(
    ("kinds", "seen"),
    [
        (("plain", "other"), 1),
        (("other", "plain"), 1),
        (("plain", "glowing"), 1),
        (("glowing", "plain"), 0),
        (("one-sided", "glowing"), 1),
        (("glowing", "one-sided"), 0),
        (("plain", "coloured"), 1),
        (("coloured", "plain"), 0),
        (("glowing", "coloured", "other"), None),
        (("plain", "holed"), None),
        (("holed", "glowing"), None),
        (("holed", "coloured"), None),
        (("holed", "coloured", "plain", "glowing"), None),
    ],
)
def test_of_surfaces_in_one_place_both_ways_see_the_same(
    gpu, commands, square, monkeypatch, kinds, seen, depth_first_px
):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    monkeypatch.setattr("airlight.surface.gbuffer.DEPTH_FIRST_PX", depth_first_px)
    paints = [KINDS[kind] for kind in kinds]
    meshes = tuple(
        square((0, 0, 0), (1, 0.1, 0.2), (0.1, 1, -0.3), paint, uvs=UVS, **more)
        for paint, more in paints
    )
    scene = Scene(meshes=meshes)
    ours, plain = _drawn(gpu, commands, scene, meshes, (0.4, 0.9, 2.2))
    np.testing.assert_array_equal(ours[0], plain[0])
    np.testing.assert_allclose(ours[1], plain[1], atol=0.02)
    np.testing.assert_allclose(ours[3], plain[3], atol=0.02)
    if seen is not None:
        color = np.array(paints[seen][0].base_color) * (0.5 if "colors" in paints[seen][1] else 1.0)
        middle = ours[1][SIZE[1] // 2, SIZE[0] // 2, :3]
        np.testing.assert_allclose(middle, color, atol=1e-3)
    light = DirectionalLight((0.2, -0.3, -1.0), (3.0, 2.0, 1.0))
    (depth, _, flux), (depth_0, _, flux_0) = _lit(gpu, commands, scene, light)
    np.testing.assert_array_equal(depth, depth_0)
    assert_alike(flux, flux_0)


def _around(count, u, wrap):
    """The two texels around `u` of a row of `count`, and the share of the second one."""
    at = np.clip(u, 0.0, 1.0) * count - 0.5 if wrap == "clamp" else u * count - 0.5
    first = np.floor(at).astype(int)
    pair = np.stack([first, first + 1])
    if wrap == "repeat":
        pair %= count
    elif wrap == "mirror":
        pair %= 2 * count
        pair = np.where(pair < count, pair, 2 * count - 1 - pair)
    return np.clip(pair, 0, count - 1), at - first


def _filtered(levels, uv, lod, wraps):
    """Trilinear means of `levels` (H, W, C) at `uv` (N, 2) and `lod` (N,)."""
    lod = np.clip(lod, 0.0, len(levels) - 1.0)
    total = 0.0
    for k, level in enumerate(levels):
        (x, across), (y, down) = (
            _around(level.shape[1 - axis], uv[:, axis], wraps[axis]) for axis in (0, 1)
        )
        for i, share_x in ((0, 1.0 - across), (1, across)):
            for j, share_y in ((0, 1.0 - down), (1, down)):
                share = share_x * share_y * np.clip(1.0 - np.abs(lod - k), 0.0, 1.0)
                total = total + level[y[j], x[i]] * share[:, None]
    return total


def _footprint(steps, size):
    """The probes of a footprint, uv -> [(uv of a probe, its share (N, 1))], and their lod.

    By wgsl/footprint.wgsl: `steps` are the changes of uv to the next pixel's right and down. Last,
    where rounding does not decide how many probes there are.
    """
    lengths = np.array([np.linalg.norm(step * size, axis=1) for step in steps])
    longer = lengths.max(axis=0)
    ratio = np.clip(longer / lengths.min(axis=0), 1.0, 8.0)
    count = np.where(longer > 1.0, np.ceil(ratio - 0.05), 1.0)[:, None]
    along = np.where((lengths[0] > lengths[1])[:, None], *steps)

    def probes(uv):
        for k in range(8):
            yield uv + ((k + 0.5) / count - 0.5) * along, (k < count) / count

    is_sure = np.abs((ratio + 0.45) % 1.0 - 0.5) > 3e-3
    return probes, np.log2(longer / np.minimum(ratio, count[:, 0])), is_sure


def _uv_on_plane(clip, pixels, uv_of):
    """Where rays through `pixels` (N, 2) meet the plane z = 0, by `uv_of` (2, 3) of (x, y, 1)."""
    ndc = pixels / np.array(SIZE) * (2.0, -2.0) + (-1.0, 1.0)
    homography = clip[[0, 1, 3]][:, [0, 1, 3]]
    on = np.linalg.solve(homography, np.column_stack([ndc, np.ones(len(ndc))]).T)
    return (uv_of @ (on / on[2])).T


@pytest.mark.parametrize("wraps", [("repeat", "mirror"), ("mirror", "clamp"), ("clamp", "repeat")])
@pytest.mark.parametrize(
    ("eye", "repeats"),
    [
        ((0, 0, 2.0), 0.3),
        ((0, 0, 2.0), 2.7),
        ((0, 0, 2.0), 300.0),
        ((0.5, -3.0, 1.1), 1.3),
        ((-2.5, -2.0, 1.6), 6.0),
    ],
)
def test_packed_maps_are_filtered_as_numpy_does(gpu, commands, square, wraps, eye, repeats):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    noise = RNG.choice(np.array([0, 255], np.uint8), (8, 16, 4))  # as hard as edges come
    noise[..., 3] = 255
    base = Texture(noise, wrap=wraps)
    rough = Texture(noise[::-1].copy(), wrap=wraps, is_srgb=False)
    painted = Material(
        base_color=(1, 1, 1),
        metallic=0.0,
        roughness=1.0,
        base_color_texture=base,
        metallic_roughness_texture=rough,
    )
    half = 8.0
    uv_of = np.array([[0.4, 0.1, 0.33], [-0.2, 0.7, 0.21]]) * repeats
    mesh = square((0, 0, 0), (half, 0, 0), (0, half, 0), painted)
    corners = np.column_stack([mesh.geometry.positions[:, :2], np.ones(4)])
    uvs = (corners @ uv_of.T).astype(np.float32)
    mesh = replace(mesh, geometry=replace(mesh.geometry, uvs=uvs))
    clip = clip_from_view_infinite(0.6, SIZE[0] / SIZE[1], 0.01)
    clip = clip @ view_from_world(eye, -np.asarray(eye), (0, 0.1, 1))
    on_device, g = GpuScene(gpu, Scene(meshes=(mesh,))), GBuffer(gpu, SIZE)
    g.encode(commands, on_device, clip)
    commands.submit()
    is_seen, albedo, normal = (t.read().astype(np.float64) for t in (g.depth, g.albedo, g.normal))
    is_seen = is_seen > 0.0
    assert is_seen.mean() > 0.9

    column, row = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    pixels = np.column_stack([column[is_seen], row[is_seen]])
    quads = pixels // 2 * 2 + 0.5
    uv, at = (_uv_on_plane(clip, p, uv_of) for p in (pixels + 0.5, quads))
    steps = [_uv_on_plane(clip, quads + step, uv_of) - at for step in ((1, 0), (0, 1))]
    probes, lod, is_sure = _footprint(steps, (16, 8))
    assert is_sure.mean() > 0.95
    stored = 2.0**-11 + 1e-4  # a half float below 1, cut off; places in floats of 24 bits
    root = 1.0 / 1023.0  # twice half a step of a light's root
    for texture, found, most in (
        (base, albedo[..., :3], stored + root),
        (rough, normal[..., 3:], stored),
    ):
        levels = [level / 255.0 for level in mip_chain(texture.pixels, is_srgb=texture.is_srgb)]
        levels = [srgb_decode(v[..., :3]) if texture.is_srgb else v[..., 1:2] for v in levels]
        wanted = sum(_filtered(levels, at, lod, wraps) * share for at, share in probes(uv))
        np.testing.assert_allclose(found[is_seen][is_sure], wanted[is_sure], rtol=0.0, atol=most)


def test_hard_edges_far_off_are_as_bright_both_ways(gpu, commands, square):
    if not uses_visibility_buffer(gpu):
        pytest.skip("on this device triangles are drawn as they come")
    checks = (np.indices((16, 16)) // 2).sum(axis=0) % 2 * 255
    pixels = np.stack([checks, 255 - checks, 255 * np.eye(16), np.full((16, 16), 255)], axis=-1)
    painted = Material(base_color_texture=Texture(pixels.astype(np.uint8)))
    mesh = square((0, 0, 0), (4, 0, 0), (0, 0, -4), painted, uvs=6.0 * UVS)
    # Almost along the plane, rounding decides how many probes hard edges meet.
    for eye, most in (((0.3, 0.5, 3.8), 0.02), ((2.0, 3.0, 2.0), 0.01)):
        ours, plain = _drawn(gpu, commands, Scene(meshes=(mesh,)), (mesh,), eye)
        np.testing.assert_array_equal(ours[0], plain[0])
        is_seen = ours[0] > 0.0
        a, b = (found[1][is_seen, :3] for found in (ours, plain))
        assert is_seen.mean() > 0.5
        assert b.std() > 0.06  # edges are seen
        np.testing.assert_allclose(a.mean(axis=0), b.mean(axis=0), atol=1e-3)
        assert np.sqrt(np.mean((a - b) ** 2)) < most
