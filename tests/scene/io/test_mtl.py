"""MTL statements to materials."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from airlight.errors import SceneError
from airlight.scene.io.mtl import load_mtl
from airlight.scene.io.obj import load_obj
from airlight.scene.io.texture_files import TextureFiles


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Images: an orange, a two-tone mask, a flat normal map and a grey height map."""
    images = {
        "orange.png": np.full((4, 4, 3), (255, 128, 0), dtype=np.uint8),
        "mask.png": np.repeat(np.array([[0, 255]], dtype=np.uint8), 2, axis=0),
        "flat normals.png": np.full((2, 2, 3), (128, 128, 255), dtype=np.uint8),
        "height.png": np.full((2, 2), 90, dtype=np.uint8),
    }
    for name, pixels in images.items():
        PIL.Image.fromarray(pixels).save(tmp_path / name)
    return tmp_path


@pytest.fixture
def material(folder: Path):
    """The material `m` of an MTL text, and the warnings."""

    def load(text: str):
        (folder / "a.mtl").write_text("newmtl m\n" + text)
        textures = TextureFiles(folder / "a.obj")
        return load_mtl(folder / "a.mtl", textures)["m"], textures.warnings

    return load


def test_colours_roughness_and_emission(material):
    m, warnings = material("Kd 0.5 0.25 0\nKs 0.02 0.02 0.02\nNs 30\nKe 1 2 3\n")
    assert m.base_color == (0.5, 0.25, 0)
    assert m.specular == pytest.approx(0.5)
    assert m.roughness == pytest.approx((2 / 32) ** 0.25)
    assert m.emission == (1, 2, 3)
    assert m.two_sided
    assert (m.alpha, m.alpha_cutoff) == (1, 0)
    assert warnings == []


def test_no_highlight_without_ks(material):
    assert material("Kd 1 1 1\nNs 100\n")[0].specular == 0
    assert material("Kd 1 1 1\nillum 1\nNs 100\n")[0].roughness == 1


def test_a_bright_ks_over_black_is_a_metal(material):
    m, _ = material("Kd 0 0 0\nKs 0.9 0.7 0.3\nNs 500\n")
    assert m.metallic == 1
    assert m.base_color == (0.9, 0.7, 0.3)


def test_physical_keys_win(material):
    m, _ = material("Kd 0 0 0\nKs 1 1 1\nNs 3\nPr 0.3\nPm 0.5\n")
    assert (m.roughness, m.metallic, m.specular) == (0.3, 0.5, 1)


def test_texture_options_names_with_spaces_and_slashes(material, folder):
    (folder / "Sub").mkdir()
    PIL.Image.new("RGB", (3, 3)).save(folder / "Sub" / "two words.PNG")
    m, warnings = material("map_Kd -clamp on -s 2 3 1 -o 0.25 0.5 -bm 2 sub\\Two Words.png\n")
    assert warnings == []
    texture = m.base_color_texture
    assert texture.wrap == ("clamp", "clamp")
    assert texture.scale == (2, 3)
    # v' = 1 - ((1 - v) 3 + 0.5) = 3 v - 2.5
    assert texture.offset == (0.25, -2.5)


def test_mask_becomes_alpha_at_the_larger_size(material):
    m, _ = material("Kd 1 1 1\nmap_Kd orange.png\nd 0\nmap_d mask.png\n")
    pixels = m.base_color_texture.pixels
    assert pixels.shape == (4, 4, 4)
    assert pixels[0, 0].tolist() == [255, 128, 0, 0]
    assert pixels[0, 3].tolist() == [255, 128, 0, 255]
    assert (m.alpha, m.alpha_cutoff) == (1, 0.5)
    assert material("map_d mask.png\n")[0].base_color_texture.pixels.shape == (2, 2, 4)


@pytest.mark.parametrize(
    ("line", "alpha"), [("d 0.7", 0.7), ("Tr 0.8", 0.2), ("d 0.5\nmap_d mask.png", 0.5)]
)
def test_windows_are_blended(material, line, alpha):
    m, warnings = material(line)
    assert m.alpha == pytest.approx(alpha)
    assert (m.alpha_cutoff, m.is_blended, m.is_translucent, warnings) == (0.0, True, True, [])


def test_normal_map_and_height_map(material):
    m, warnings = material("map_Bump -bm 0.5 flat normals.png\n")
    assert m.normal_texture is not None
    assert not m.normal_texture.is_srgb
    assert m.normal_scale == 0.5
    assert warnings == []
    m, warnings = material("bump height.png\n")
    assert m.normal_texture is None
    assert "height map" in warnings[0]


def test_roughness_and_metallic_maps_are_packed_as_in_gltf(material):
    m, _ = material("map_Pr mask.png\nmap_Pm height.png\n")
    assert m.metallic_roughness_texture.pixels[0, :, 1].tolist() == [0, 255]
    assert m.metallic_roughness_texture.pixels[0, :, 2].tolist() == [90, 90]
    assert (m.roughness, m.metallic) == (1, 1)


def test_emission_map_without_ke(material):
    m, _ = material("map_Ke orange.png\n")
    assert m.emission == (1, 1, 1)
    assert m.emission_texture.pixels[0, 0, 1] == 128


def test_missing_texture_is_a_magenta_checker_with_a_warning(material):
    m, warnings = material("Kd 1 1 1\nmap_Kd gone.png\nmap_Bump lost.png\n")
    assert m.base_color_texture.pixels[0, 1].tolist() == [255, 0, 255, 255]
    assert m.normal_texture is None
    assert "texture 'gone.png' is missing; a magenta checker stands in" in warnings[0]
    assert "texture 'lost.png' is missing; the surface goes without" in warnings[1]


def test_kd_above_one_is_cut_and_said(material):
    m, warnings = material("Kd 2 0.5 0.5\n")
    assert m.base_color == (1, 0.5, 0.5)
    assert "above 1" in warnings[0]


def test_bad_number_names_the_line(folder):
    (folder / "b.mtl").write_text("newmtl m\nKd 1 red 0\n")
    with pytest.raises(SceneError) as error:
        load_mtl(folder / "b.mtl", TextureFiles(folder / "a.obj"))
    assert str(error.value).endswith("b.mtl, line 2: 'kd 1 red 0' is not a list of numbers")


def test_a_tr_of_1_alone_is_meshlab_s_opaque(material):
    m, warnings = material("Kd 1 1 1\nTr 1.000000\n")
    assert m.alpha == 1.0
    (line,) = warnings
    assert "'Tr 1' of 'm' is taken for opaque" in line


@pytest.mark.parametrize(
    ("text", "alpha"),
    [("Tr 0\n", 1.0), ("Tr 0.75\n", 0.25), ("d 0\nTr 1\n", 0.0), ("d 0\n", 0.0)],
)
def test_other_transparency_is_one_minus_opacity(material, text, alpha):
    assert material(text)[0].alpha == alpha


def test_a_black_kd_beside_an_image_shows_the_image(material):
    m, _ = material("Kd 0 0 0\nmap_Kd orange.png\n")
    assert m.base_color == (1.0, 1.0, 1.0)
    assert m.base_color_texture is not None
    assert material("Kd 0.5 0 0\nmap_Kd orange.png\n")[0].base_color == (0.5, 0.0, 0.0)
    assert material("Kd 0 0 0\n")[0].base_color == (0.0, 0.0, 0.0)


def test_statements_that_are_not_read_are_named_unless_they_say_nothing(material):
    _, warnings = material("Kd 1 1 1\nPc 0.5\nrefl -type sphere a.png\nPs 0\naniso 0.0\nNi 1.45\n")
    (line,) = warnings
    assert "'pc', 'refl' of 'm' are not read" in line


@pytest.mark.parametrize(
    ("line", "named"),
    [
        ("Kd spectral red.rfl", "'kd spectral'"),
        ("Ks xyz 1 1 1", "'ks xyz'"),
        ("map_Kd -mm 0 2 brick.png", "'map_kd -mm'"),
        ("map_Pr -imfchan g brick.png", "'map_pr -imfchan'"),
    ],
)
def test_what_a_statement_asks_for_beyond_numbers_is_named(tmp_path, line, named):
    (tmp_path / "tri.obj").write_text(
        "mtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    )
    (tmp_path / "a.mtl").write_text(f"newmtl a\n{line}\n")
    assert any(named in text for text in load_obj(tmp_path / "tri.obj").warnings)
    (tmp_path / "a.mtl").write_text("newmtl a\nKd 1 0 0\nmap_Kd -s 2 2 -o 1 1 brick.png\n")
    assert not any("left out" in text for text in load_obj(tmp_path / "tri.obj").warnings)
