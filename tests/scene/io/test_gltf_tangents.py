"""Tangents of glTF files: normal maps lie by them, and those that say nothing new are dropped."""

from __future__ import annotations

import base64
import io

import numpy as np
import PIL.Image
import pytest

import airlight as al
from airlight.scene.io.gltf import load_gltf
from airlight.scene.io.gltf_write import write_gltf

SQUARE = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
UPRIGHT = [(0, 1), (1, 1), (1, 0), (0, 0)]
TURNED = [(0, 0), (0, 1), (1, 1), (1, 0)]  # u goes up the square
MIRRORED = [(1, 1), (0, 1), (0, 0), (1, 0)]
STRETCHED = [(0, 2), (1, 2), (1, 0), (0, 0)]
TO_RED = (204, 128, 230)  # a normal of (.6, 0, .8)


def square(draft, tangents, uvs=UPRIGHT, *, has_map=True, texture=None, **primitive):
    """A square that faces +Z, with a normal map of one colour, and tangents (4,) or (4, 4)."""
    held = io.BytesIO()
    PIL.Image.new("RGB", (2, 2), TO_RED).save(held, "png")
    data = "data:image/png;base64," + base64.b64encode(held.getvalue()).decode()
    draft.json["images"], draft.json["textures"] = [{"uri": data}], [{"source": 0}]
    used = {"normalTexture": {"index": 0, **(texture or {})}} if has_map else {}
    gloss = {"pbrMetallicRoughness": {"metallicFactor": 0.0}}
    draft.json["materials"] = [used | gloss]
    attributes = {
        "POSITION": draft.array(SQUARE, "f4"),
        "NORMAL": draft.array([(0, 0, 1)] * 4, "f4"),
        "TEXCOORD_0": draft.array(uvs, "f4"),
        "TANGENT": draft.array(np.broadcast_to(tangents, (4, np.shape(tangents)[-1])), "f4"),
    }
    indices = draft.array([0, 1, 2, 0, 2, 3], "u1")
    made = {"attributes": attributes, "indices": indices, "material": 0, **primitive}
    return draft.single(made)


def read(draft, tangents, uvs=UPRIGHT, **more):
    """The geometry of the square, and the warnings about it."""
    scene = load_gltf(square(draft, tangents, uvs, **more).glb())
    return scene.meshes[0].geometry, [w for w in scene.warnings if "TANGENT" in w]


@pytest.mark.parametrize(
    ("tangent", "uvs"),
    [((1, 0, 0, 1), UPRIGHT), ((0, 1, 0, 1), TURNED), ((-1, 0, 0, -1), MIRRORED),
     ((1, 0.01, 0.5, 1), UPRIGHT), ((0, 0, 0, 1), UPRIGHT)],
)  # fmt: skip
def test_tangents_that_say_what_uvs_say_are_dropped(draft, tangent, uvs):
    geometry, warnings = read(draft, tangent, uvs)
    assert geometry.tangents is None
    assert warnings == []


@pytest.mark.parametrize(
    ("tangent", "uvs"),
    [((0, 1, 0, 1), UPRIGHT), ((1, 0, 0, 1), MIRRORED), ((1, 0.1, 0, 1), UPRIGHT),
     ((1, 0, 0, -1), UPRIGHT), ((1, 0, 0, 1), STRETCHED), ((1, 0, 0, 1), np.zeros((4, 2)))],
)  # fmt: skip
def test_others_are_read_where_there_is_a_normal_map(draft, tangent, uvs):
    geometry, warnings = read(draft, tangent, uvs)
    np.testing.assert_array_equal(geometry.tangents, np.float32([tangent] * 4))
    assert warnings == []
    assert read(draft, tangent, uvs, has_map=False)[0].tangents is None


def test_one_corner_that_differs_is_enough(draft):
    corners = [(1, 0, 0, 1)] * 3 + [(0, 1, 0, 1)]
    np.testing.assert_array_equal(read(draft, corners)[0].tangents, np.float32(corners))


@pytest.mark.parametrize(
    ("tangent", "problem"),
    [((np.nan, 1, 0, 1), "NaN"), ((0, 1, 0), "3 components, not 4")],
)
def test_broken_ones_are_told(draft, tangent, problem):
    geometry, (warning,) = read(draft, tangent)
    assert geometry.tangents is None
    assert "its TANGENT is left out" in warning
    assert problem in warning


def test_without_normals_there_are_none(draft):
    made = square(draft, (0, 1, 0, 1))
    del made.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"]
    scene = load_gltf(made.glb())
    assert scene.meshes[0].geometry.tangents is None


def lit(scene, turned=False):
    """The image of the square under light along -X, which the normal map turns it towards."""
    light = al.DirectionalLight(direction=(-1.0, 0.0, -1e-3), irradiance=(1.0, 1.0, 1.0))
    camera = al.Camera(position=(0.0, 0.0, 3.0), target=(0.0, 0.0, 0.0), fov_y_deg=20.0)
    whole = al.Scene(meshes=scene.meshes, lights=(light,), camera=camera)
    return float(al.render(whole, technique="direct", size=(16, 16), samples=1).radiance.mean())


def test_the_image_is_that_of_the_tangents(draft, tmp_path):
    """Red leans to +X by the coordinates; tangents turn it down, away, and, mirrored, back."""
    towards = lit(load_gltf(square(draft, (1, 0, 0, 1)).glb()))
    assert towards > 0.6 * 0.8 / np.pi  # what Lambert sends back, and some gloss
    for tangent in ((0, -1, 0, 1), (-1, 0, 0, 1)):
        assert lit(load_gltf(square(draft, tangent).glb())) < 0.02 * towards
    # Again as airlight writes it, also where the placement shears and mirrors.
    scene = load_gltf(square(draft, (1, 0, 0, 1), MIRRORED).glb())
    assert lit(scene) == pytest.approx(towards, rel=0.01)
    for place in (np.eye(4), _placed([[-1, 0.3, 0], [0, 1, 0], [0, 0, 1]])):
        moved = al.Scene(
            meshes=(al.Mesh(scene.meshes[0].geometry, scene.meshes[0].material, place),)
        )
        write_gltf(moved, tmp_path / "again.glb")
        assert lit(load_gltf(tmp_path / "again.glb")) == pytest.approx(
            lit(moved), abs=0.01 * towards
        )


def _placed(linear):
    matrix = np.eye(4)
    matrix[:3, :3] = linear
    return matrix


def test_morph_targets_turn_tangents(draft):
    target = {"TANGENT": draft.array([(-1, 1, 0)] * 4, "f4")}
    made = square(draft, (1, 0, 0, -1), targets=[target])
    made.json["meshes"][0]["weights"] = [1.0]
    scene = load_gltf(made.glb())
    scene = scene.animation.at_rest(scene) if scene.animation else scene
    np.testing.assert_allclose(scene.meshes[0].geometry.tangents, [(0, 1, 0, -1)] * 4, atol=1e-6)


def test_a_map_of_other_coordinates_is_not_turned_where_tangents_are(draft):
    """An image drawn again in another set of coordinates leans by the file's tangents still."""
    made = square(draft, (0, 1, 0, 1), texture={"texCoord": 1})
    primitive = made.json["meshes"][0]["primitives"][0]
    primitive["attributes"]["TEXCOORD_1"] = draft.array(TURNED, "f4")
    draft.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    draft.json["materials"][0]["emissiveTexture"] = {"index": 0}
    scene = load_gltf(made.glb())
    mesh = scene.meshes[0]
    assert mesh.geometry.tangents is not None
    normals = mesh.material.normal_texture.pixels[..., :3].reshape(-1, 3)
    np.testing.assert_allclose(normals, np.tile(TO_RED, (len(normals), 1)), atol=1)
