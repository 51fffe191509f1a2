"""glTF materials, and a word on everything that is approximated."""

from __future__ import annotations

import base64
import io

import numpy as np
import PIL.Image
import pytest

from airlight.errors import SceneError
from airlight.scene.io.gltf import load_gltf


def png(color) -> bytes:
    file = io.BytesIO()
    PIL.Image.new("RGBA", (2, 2), color).save(file, "PNG")
    return file.getvalue()


@pytest.fixture
def material(draft):
    """The material and warnings of a triangle that wears `spec`."""

    def load(spec: dict, **top):
        uvs = draft.array([(0, 0), (1, 0), (0, 1)], "f4")
        draft.single({**draft.triangle(TEXCOORD_0=uvs), "material": 0})
        draft.json.update(materials=[spec], **top)
        scene = load_gltf(draft.glb())
        return scene.meshes[0].material, scene.warnings

    return load


def test_defaults_are_the_specifications(material):
    m, warnings = material({})
    assert (m.base_color, m.metallic, m.roughness) == ((1, 1, 1), 1, 1)
    assert not m.two_sided
    assert m.alpha_cutoff == 0
    assert warnings == ()


def test_factors_and_every_texture(material, draft):
    images = [png((255, 0, 0, 255)), png((0, 90, 30, 255)), png((128, 128, 255, 255))]
    draft.json["images"] = [
        {"bufferView": draft.view(images[0]), "mimeType": "image/png"},
        {"uri": "data:image/png;base64," + base64.b64encode(images[1]).decode()},
        {"uri": "a%20b.png"},
    ]
    (draft.folder / "a b.png").write_bytes(images[2])
    draft.json["samplers"] = [{"wrapS": 33071, "wrapT": 33648}]
    draft.json["textures"] = [{"source": k, "sampler": 0} for k in range(3)]
    transform = {"KHR_texture_transform": {"scale": [2, 3], "offset": [0.5, 0.25]}}
    m, warnings = material(
        {
            "name": "brass",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.25, 1, 0.3],
                "baseColorTexture": {"index": 0, "extensions": transform},
                "metallicFactor": 0.5,
                "roughnessFactor": 0.25,
                "metallicRoughnessTexture": {"index": 1},
            },
            "normalTexture": {"index": 2, "scale": 0.5},
            "emissiveTexture": {"index": 0},
            "emissiveFactor": [1, 0.5, 0],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}},
            "doubleSided": True,
        }
    )
    assert warnings == ()
    assert m.name == "brass"
    assert m.base_color == (0.5, 0.25, 1)
    assert m.alpha == 1  # OPAQUE ignores it
    assert (m.metallic, m.roughness, m.normal_scale) == (0.5, 0.25, 0.5)
    assert m.emission == (8, 4, 0)
    assert m.base_color_texture.is_srgb
    assert m.base_color_texture.scale == (2, 3)
    assert m.base_color_texture.offset == (0.5, 0.25)
    assert m.base_color_texture.wrap == ("clamp", "mirror")
    assert not m.metallic_roughness_texture.is_srgb
    assert m.metallic_roughness_texture.pixels[0, 0].tolist() == [0, 90, 30, 255]
    assert m.normal_texture.pixels[0, 0, 2] == 255
    np.testing.assert_array_equal(m.emission_texture.pixels, m.base_color_texture.pixels)


def test_mask_and_blend(material):
    m, warnings = material({"alphaMode": "MASK", "alphaCutoff": 0.3})
    assert (m.alpha_cutoff, warnings) == (0.3, ())
    m, warnings = material(
        {"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}}
    )
    assert (m.alpha, m.alpha_cutoff, m.is_blended, warnings) == (0.2, 0.0, True, ())
    glass = {
        "pbrMetallicRoughness": {"roughnessFactor": 0.0, "metallicFactor": 0.0},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.9}},
    }
    m, warnings = material(glass)
    assert (m.alpha, m.alpha_cutoff, m.transmission, warnings) == (1, 0.0, 0.9, ())
    assert m.is_translucent
    frosted = {"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}
    _, warnings = material(frosted)
    assert "materials[0]: its glass is rough" in warnings[0]


def test_extensions_understood_and_not(material):
    m, warnings = material(
        {
            "extensions": {
                "KHR_materials_ior": {"ior": 1.2},
                "KHR_materials_clearcoat": {"clearcoatFactor": 1},
            }
        }
    )
    assert m.specular == pytest.approx((0.2 / 2.2) ** 2 / 0.04)
    assert len(warnings) == 1
    assert "KHR_materials_clearcoat is not supported" in warnings[0]
    m, warnings = material({"extensions": {"KHR_materials_unlit": {}}})
    assert (m.is_unlit, m.metallic, m.specular) == (True, 0, 0)
    assert not warnings
    old = {"diffuseFactor": [0.1, 0.2, 0.3, 1], "glossinessFactor": 0.75}
    m, warnings = material({"extensions": {"KHR_materials_pbrSpecularGlossiness": old}})
    assert m.base_color == (0.1, 0.2, 0.3)
    assert (m.roughness, m.metallic) == (0.25, 0)


def test_missing_and_broken_images(material, draft):
    draft.json["images"] = [{"uri": "gone.png"}, {"bufferView": draft.view(b"junk")}]
    draft.json["textures"] = [{"source": 0}, {"source": 1}]
    m, warnings = material(
        {
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
            "normalTexture": {"index": 1},
        }
    )
    assert m.base_color_texture.pixels[0, 1].tolist() == [255, 0, 255, 255]
    assert m.normal_texture is None
    assert "images[0] (gone.png): file not found; a magenta checker stands in" in warnings[0]
    assert "images[1]: not a readable image" in warnings[1]


def test_second_texture_coordinates(draft):
    draft.json["images"] = [{"bufferView": draft.view(png("red"))}]
    draft.json["textures"] = [{"source": 0}]
    primitive = draft.triangle(
        TEXCOORD_0=draft.array([(0, 0)] * 3, "f4"), TEXCOORD_1=draft.array([(7, 7)] * 3, "f4")
    )
    draft.single({**primitive, "material": 0})
    base = {"index": 0, "texCoord": 1}
    draft.json["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": base}}]
    np.testing.assert_array_equal(load_gltf(draft.glb()).meshes[0].geometry.uvs, [(7, 7)] * 3)


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ({"alphaMode": "SOME"}, "materials[0].alphaMode: 'SOME' is unknown"),
        (
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": 3}}},
            "materials[0].pbrMetallicRoughness.baseColorTexture.index: is 3, but the file has 0",
        ),
        ({"emissiveFactor": "red"}, "materials[0].emissiveFactor: must be 3 finite numbers"),
    ],
)
def test_bad_materials(material, spec, message):
    with pytest.raises(SceneError) as error:
        material(spec)
    assert message in str(error.value)


CORNERS = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]


@pytest.fixture
def placed(draft):
    """The mesh and warnings of a triangle with CORNERS for coordinates that wears `spec`."""

    def load(spec: dict):
        draft.json["images"] = [{"bufferView": draft.view(png("red"))}]
        draft.json["textures"] = [{"source": 0}]
        uvs = draft.array(CORNERS, "f4")
        draft.single({**draft.triangle(TEXCOORD_0=uvs), "material": 0})
        draft.json["materials"] = [spec]
        scene = load_gltf(draft.glb())
        return scene.meshes[0], scene.warnings

    return load


def image_of(texture, mesh):
    """Where in the image each vertex lies."""
    return mesh.geometry.uvs * np.array(texture.scale) + np.array(texture.offset)


def at(**transform):
    return {"index": 0, "extensions": {"KHR_texture_transform": transform}}


def test_a_turned_image_lies_where_the_extensions_own_example_has_it(placed):
    # Offset [0, 1], a quarter turn, half the size: "only the lower left quadrant of the source
    # image, rotated clockwise 90 degrees". The upper left of what is shown is then the image's
    # lower left corner (v runs downwards), its upper right the middle of the left edge.
    base = at(offset=[0, 1], rotation=np.pi / 2, scale=[0.5, 0.5])
    mesh, warnings = placed({"pbrMetallicRoughness": {"baseColorTexture": base}})
    expected = [(0.0, 1.0), (0.0, 0.5), (0.5, 1.0)]
    np.testing.assert_allclose(
        image_of(mesh.material.base_color_texture, mesh), expected, atol=1e-6
    )
    assert warnings == ()


def test_scale_comes_before_rotation(placed):
    c, s = np.cos(0.3), np.sin(0.3)
    base = at(offset=[0.25, -0.5], rotation=0.3, scale=[2, 3])
    mesh, _ = placed({"pbrMetallicRoughness": {"baseColorTexture": base}})
    # (u, v) -> (c 2u + s 3v, -s 2u + c 3v) + offset, written out corner by corner.
    expected = [(0.25, -0.5), (2 * c + 0.25, -2 * s - 0.5), (3 * s + 0.25, 3 * c - 0.5)]
    np.testing.assert_allclose(
        image_of(mesh.material.base_color_texture, mesh), expected, atol=1e-6
    )


def test_images_turned_alike_keep_their_own_size_and_place(placed):
    pbr = {"baseColorTexture": at(rotation=0.5, scale=[2, 2])}
    normal = at(rotation=0.5, scale=[8, 8], offset=[0.125, 0])
    mesh, warnings = placed({"pbrMetallicRoughness": pbr, "normalTexture": normal})
    base, bumps = mesh.material.base_color_texture, mesh.material.normal_texture
    np.testing.assert_allclose(
        image_of(bumps, mesh), 4.0 * image_of(base, mesh) + (0.125, 0), atol=1e-6
    )
    assert warnings == ()
