"""Images of one material that lie by several texture coordinates: what each point shows."""

import io

import numpy as np
import PIL.Image
import pytest

from airlight.scene.io.gltf import load_gltf
from airlight.scene.io.texture_bake import Charts, baked
from airlight.scene.material import Texture
from airlight.scene.texels import interpolated

SIZE = 32
GRID = [(0, 0), (1, 0), (1, 1), (0, 1)]
SQUARE = [(0, 1, 2), (0, 2, 3)]


def waves(phase: float) -> np.ndarray:
    """A smooth image that repeats, unlike itself turned or mirrored."""
    v, u = np.meshgrid(*2 * [(np.arange(SIZE) + 0.5) / SIZE * 2 * np.pi], indexing="ij")
    planes = [np.sin(u + phase), np.cos(v + 2 * phase), np.sin(u + v + phase)]
    return np.round(127.5 + 60.0 * np.stack(planes, axis=-1)).astype(np.uint8)


def png(pixels) -> bytes:
    file = io.BytesIO()
    PIL.Image.fromarray(pixels).save(file, "png")
    return file.getvalue()


@pytest.fixture
def loaded(draft):
    """The mesh and warnings of triangles with two sets of coordinates that wear `spec`."""

    def load(spec, triangles, *sets, positions=None):
        images = [draft.view(png(waves(phase))) for phase in (0.3, 1.1)]
        draft.json["images"] = [{"bufferView": view} for view in images]
        draft.json["textures"] = [{"source": 0}, {"source": 1}]
        corners = np.array(positions if positions is not None else sets[0], float)
        corners = np.pad(corners, ((0, 0), (0, 3 - corners.shape[1])))
        named = {f"TEXCOORD_{k}": draft.array(uvs, "f4") for k, uvs in enumerate(sets)}
        primitive = {
            "attributes": {"POSITION": draft.array(corners, "f4"), **named},
            "indices": draft.array(np.ravel(triangles), "u2"),
            "material": 0,
        }
        draft.single(primitive)
        draft.json["materials"] = [spec]
        scene = load_gltf(draft.glb())
        return scene.meshes[0], scene.warnings

    return load


def shown(mesh, texture, shares):
    """Bytes (T, S, 3) of a texture at points of triangles, by `shares` (S, 3) of corners."""
    uvs = mesh.geometry.uvs[mesh.geometry.indices].astype(np.float64)
    at = (shares @ uvs) * np.array(texture.scale) + np.array(texture.offset)
    values = interpolated(texture.pixels / 255.0, at.reshape(-1, 2), texture.wrap)
    return 255.0 * values[:, :3].reshape(*at.shape[:2], 3)


def wanted(uvs, triangles, phase, shares):
    """The same from the image itself and where the file has it."""
    at = shares @ np.asarray(uvs, float)[np.asarray(triangles)]
    image = np.pad(waves(phase), ((0, 0), (0, 0), (0, 1))) / 255.0
    values = interpolated(image, at.reshape(-1, 2), ("repeat", "repeat"))
    return 255.0 * values[:, :3].reshape(*at.shape[:2], 3)


@pytest.fixture
def shares():
    return np.random.default_rng(4).dirichlet((1, 1, 1), 200)


# An image between texels is its chord: off by up to 60 (2 pi / 32)^2 / 8 = .29 of a byte, of which
# the new image's chords, half as long, have a quarter; sRGB's curve bends them by less, and
# rounding to bytes is .5 once.
CLOSE = 1.0


def both(base, glow):
    pbr = {"baseColorTexture": {"index": 0, **base}}
    emissive = {"index": 1, **glow}
    return {"pbrMetallicRoughness": pbr, "emissiveFactor": [1, 1, 1], "emissiveTexture": emissive}


def close(mesh, sets, triangles, shares):
    material = mesh.material
    for texture, uvs, phase in zip(
        (material.base_color_texture, material.emission_texture), sets, (0.3, 1.1), strict=True
    ):
        difference = np.abs(shown(mesh, texture, shares) - wanted(uvs, triangles, phase, shares))
        assert difference.max() < CLOSE


def test_a_set_of_its_own_for_an_image(loaded, shares):
    first = 1.7 * np.array(GRID) - 0.4
    second = [(0.2, 0.9), (0.1, 0.3), (1.9, 0.2), (0.8, 0.7)]
    mesh, warnings = loaded(both({}, {"texCoord": 1}), SQUARE, first, second)
    assert warnings == ()
    np.testing.assert_array_equal(mesh.geometry.uvs, first.astype(np.float32))
    close(mesh, (first, second), SQUARE, shares)


def test_of_two_sets_the_one_without_overlap_is_kept(loaded, shares):
    # Two squares that show one image, and each a half of another one.
    first, second = np.array(GRID + GRID, float), np.array(GRID + GRID) * (0.5, 1.0)
    second[4:, 0] += 0.5
    triangles = [*SQUARE, *(np.array(SQUARE) + 4)]
    mesh, warnings = loaded(both({}, {"texCoord": 1}), triangles, first, second)
    assert warnings == ()
    np.testing.assert_array_equal(mesh.geometry.uvs, second.astype(np.float32))
    close(mesh, (first, second), triangles, shares)


def test_where_all_sets_overlap_charts_are_laid_side_by_side(loaded, shares):
    first = np.array(3 * GRID, float)
    second = np.concatenate([GRID, 0.5 * np.array(GRID), GRID])
    second[8:] = second[8:, ::-1]
    triangles = [*SQUARE, *(np.array(SQUARE) + 4), *(np.array(SQUARE) + 8)]
    mesh, warnings = loaded(both({}, {"texCoord": 1}), triangles, first, second)
    assert warnings == ()
    close(mesh, (first, second), triangles, shares)


def test_an_overlap_in_a_chart_is_told(loaded):
    # A strip folded onto itself in each set, at another place.
    u = np.array([0.0, 1.0, 0.5])
    first = [(x, y) for x in u for y in (0, 1)]
    second = [(x, y) for x in (0.0, 0.3, 0.1) for y in (0, 1)]
    triangles = [(0, 2, 3), (0, 3, 1), (2, 4, 5), (2, 5, 3)]
    places = [(x, y) for x in range(3) for y in (0, 1)]
    base, glow = {}, {"texCoord": 1}
    _, warnings = loaded(both(base, glow), triangles, first, second, positions=places)
    (warning,) = warnings
    assert "primitives[0]: of material" in warning
    assert "overlaps itself in each set of texture coordinates, and is wrong on " in warning


def test_images_turned_by_several_angles(loaded, shares):
    turns = (0.5, -0.2)
    base, glow = ({"extensions": {"KHR_texture_transform": {"rotation": a}}} for a in turns)
    mesh, warnings = loaded(both(base, glow), SQUARE, GRID)
    assert warnings == ()
    sets = []
    for angle in turns:
        c, s = np.cos(angle), np.sin(angle)
        sets.append(np.array(GRID) @ np.array([[c, s], [-s, c]]).T)
    close(mesh, sets, SQUARE, shares)


def test_bumps_turn_with_their_image(loaded):
    first = np.array(GRID, float)
    quarter = np.stack([first[:, 1], 1.0 - first[:, 0]], axis=1)
    flat = np.full((SIZE, SIZE, 3), (255, 128, 128), np.uint8)
    pixels = np.pad(flat, ((0, 0), (0, 0), (0, 1)), constant_values=255)
    made = baked(
        Texture(pixels, is_srgb=False),
        Charts(first[np.array(SQUARE)], quarter[np.array(SQUARE)]),
        is_normal=True,
    )
    # u of the image grows where v of the surface does: downwards, and green is up.
    middle = made.texture.pixels[made.texture.pixels.shape[0] // 2, 128]
    np.testing.assert_allclose(middle[:3], (128, 0, 128), atol=1)
    assert made.conflict == 0.0 and not made.is_coarse
