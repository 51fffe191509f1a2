"""`airlight convert`: scenes to Mitsuba and back, images between formats, plain refusals."""

from __future__ import annotations

import numpy as np
import PIL.Image
import pytest

from airlight.app import cli
from airlight.scene.image import Image
from airlight.scene.io import load
from airlight.scene.io.images import load_image

RAMP = (np.linspace(0.0, 0.8, 24).reshape(2, 4, 3)).astype(np.float32)


def test_a_scene_to_mitsuba_reads_back_the_same(tmp_path, capsys):
    target = tmp_path / "cornell.xml"
    assert cli.run(["convert", "builtin:cornell", str(target)]) == 0
    assert capsys.readouterr().out == f"{target}\n"
    own, back = load("builtin:cornell"), load(target)
    assert back.triangle_count == own.triangle_count
    np.testing.assert_allclose(back.bounds, own.bounds, atol=1e-5)
    np.testing.assert_allclose(back.camera.position, own.camera.position, atol=1e-5)
    assert len(back.lights) == len(own.lights)


def test_a_linear_image_keeps_its_layers_and_its_values(tmp_path):
    Image(RAMP, {"direct": RAMP * 0.5}).save(tmp_path / "a.exr")
    assert cli.run(["convert", str(tmp_path / "a.exr"), str(tmp_path / "b.exr")]) == 0
    back = load_image(tmp_path / "b.exr")
    np.testing.assert_array_equal(back.radiance, RAMP)
    np.testing.assert_array_equal(back.layers["direct"], RAMP * 0.5)
    assert cli.run(["convert", str(tmp_path / "a.exr"), str(tmp_path / "b.hdr")]) == 0
    np.testing.assert_allclose(load_image(tmp_path / "b.hdr").radiance, RAMP, atol=0.01)


def test_exposure_and_curve_shape_the_display(tmp_path):
    Image(RAMP).save(tmp_path / "a.exr")
    out = str(tmp_path / "a.png")
    words = ["convert", str(tmp_path / "a.exr"), out, "--tone-map", "none", "--exposure", "-1"]
    assert cli.run(words) == 0
    shown = np.asarray(PIL.Image.open(out), dtype=np.float64) / 255.0
    half = RAMP / 2.0
    expected = np.where(half <= 0.0031308, 12.92 * half, 1.055 * half ** (1 / 2.4) - 0.055)
    # Half a code of dither and half of rounding.
    np.testing.assert_allclose(shown, expected, atol=1.0 / 255.0)


@pytest.mark.parametrize("light", [1e-4, 1.0, 3e4])
def test_exposure_auto_shows_any_light_alike(tmp_path, light):
    shown = []
    for scale in (1.0, light):
        Image(np.float32(scale) * RAMP).save(tmp_path / "a.exr")
        words = ["convert", str(tmp_path / "a.exr"), str(tmp_path / "a.png"), "--exposure", "auto"]
        assert cli.run(words) == 0
        shown.append(np.asarray(PIL.Image.open(tmp_path / "a.png"), dtype=np.float64))
    # Rounding of a code; and half floats of the file, where light is small.
    np.testing.assert_allclose(shown[1], shown[0], atol=2.0)


def test_an_eight_bit_image_comes_back_as_it_was(tmp_path):
    pixels = np.random.default_rng(2).integers(0, 256, (5, 7, 3), dtype=np.uint8)
    PIL.Image.fromarray(pixels).save(tmp_path / "a.png")
    assert cli.run(["convert", str(tmp_path / "a.png"), str(tmp_path / "a.exr")]) == 0
    assert cli.run(["convert", str(tmp_path / "a.png"), str(tmp_path / "b.png")]) == 0
    np.testing.assert_array_equal(np.asarray(PIL.Image.open(tmp_path / "b.png")), pixels)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["{in}.exr", "{in}.tga"],
            "error: {in}.tga: cannot write an image that ends in '.tga'. "
            "End its name in one of .exr, .hdr, .png, .jpg, .jpeg.",
        ),
        (
            ["builtin:cornell", "{in}.obj"],
            "error: {in}.obj: a scene cannot be written as '.obj'. "
            "End its name in .xml, for Mitsuba 3, in .glb or in .toml.",
        ),
        (["nowhere.toml", "{in}.xml"], "error: nowhere.toml: file not found. Check the path."),
        (
            ["builtin:cornell", "{in}.xml", "--exposure", "1"],
            "error: builtin:cornell: --exposure, --tone-map and --lut are for images",
        ),
        (["{in}.blend", "{in}.xml"], "error: {in}.blend: a scene file cannot end in '.blend'."),
    ],
)
def test_what_cannot_be_is_one_message(tmp_path, capsys, words, message):
    place = str(tmp_path / "a")
    Image(RAMP).save(f"{place}.exr")
    before = sorted(tmp_path.iterdir())
    assert cli.run(["convert", *(word.replace("{in}", place) for word in words)]) == 2
    assert capsys.readouterr().err.startswith(message.replace("{in}", place))
    assert sorted(tmp_path.iterdir()) == before


def test_a_scene_is_not_written_over_itself(tmp_path, capsys):
    path = tmp_path / "a.xml"
    path.write_text("<scene version='3.0.0'/>")
    assert cli.run(["convert", str(path), str(path)]) == 2
    assert "the command reads this file" in capsys.readouterr().err
    assert path.read_text() == "<scene version='3.0.0'/>"


def test_a_scene_as_a_scene_file(tmp_path, capsys):
    (tmp_path / "tri.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    folder = tmp_path / "deep"
    folder.mkdir()
    assert cli.run(["convert", str(tmp_path / "tri.obj"), str(folder / "a.toml")]) == 0
    scene, before = load(folder / "a.toml"), load(tmp_path / "tri.obj")
    assert scene.camera == before.camera
    assert scene.lights == before.lights
    assert scene.triangle_count == 1
    assert 'file = "../tri.obj"' in (folder / "a.toml").read_text()


XML = """<scene version="3.0.0">
<shape type="cube"><bsdf type="diffuse"><rgb name="reflectance" value="0.1, 0.5, 0.9"/></bsdf>
  <transform name="to_world"><scale x="1" y="2" z="3"/><translate x="4"/></transform></shape>
<shape type="sphere"><bsdf type="roughconductor"><float name="alpha" value="0.25"/></bsdf></shape>
<emitter type="point"><point name="position" x="0" y="5" z="0"/><rgb name="intensity" value="7"/>
</emitter>
<emitter type="constant"><rgb name="radiance" value="0.25"/></emitter></scene>"""


def test_parameters_of_a_scene_are_values_in_the_scene_file(tmp_path):
    source, target = tmp_path / "a.xml", tmp_path / "b.toml"
    source.write_text(XML.replace('value="0.25"', 'value="$glow"'))
    assert cli.run(["convert", str(source), str(target), "--param", "glow=0.5"]) == 0
    assert load(target).environment.radiance == (0.5, 0.5, 0.5)


def test_no_mesh_is_lost_in_a_scene_file(tmp_path, capsys):
    source, target = tmp_path / "a.xml", tmp_path / "deep" / "b.toml"
    target.parent.mkdir()
    source.write_text(XML)
    for _ in range(2):  # once more over its own files
        assert cli.run(["convert", str(source), str(target)]) == 0
    assert sorted(p.name for p in target.parent.iterdir()) == ["b.toml", "b_meshes.glb"]
    assert 'file = "b_meshes.glb"' in target.read_text()
    before, after = load(source), load(target)
    assert after.lights == before.lights
    assert after.camera == before.camera
    assert after.environment.radiance == before.environment.radiance
    assert len(after.meshes) == len(before.meshes) == 2
    for old, new in zip(before.meshes, after.meshes, strict=True):
        np.testing.assert_allclose(new.world_bounds, old.world_bounds, atol=1e-5)
        assert len(new.geometry.indices) == len(old.geometry.indices)
        for name in ("base_color", "roughness", "metallic", "specular", "two_sided"):
            np.testing.assert_allclose(
                getattr(new.material, name), getattr(old.material, name), rtol=1e-6, err_msg=name
            )


def test_lights_are_not_lost_where_media_are_the_only_shapes(tmp_path):
    """A scene without visible meshes has no file that would bring its lights."""
    (tmp_path / "tetrahedron.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    )
    source, target = tmp_path / "a.xml", tmp_path / "b.toml"
    source.write_text(
        """<scene version="3.0.0"><shape type="obj">
<string name="filename" value="tetrahedron.obj"/>
<bsdf type="null"/><medium type="homogeneous" name="interior"><rgb name="sigma_t" value="2"/>
</medium></shape><emitter type="point"><point name="position" x="0" y="5" z="0"/>
<rgb name="intensity" value="7"/></emitter></scene>"""
    )
    assert cli.run(["convert", str(source), str(target)]) == 0
    before, after = load(source), load(target)
    assert before.lights and after.lights == before.lights
    assert (after.environment is None) == (before.environment is None)
    assert len(after.volumes) == len(before.volumes) == 1


def test_meshes_take_no_other_file_s_place(tmp_path, capsys):
    source, taken = tmp_path / "a.xml", tmp_path / "b_meshes.glb"
    source.write_text(XML)
    taken.write_bytes(b"somebody's")
    assert cli.run(["convert", str(source), str(tmp_path / "b.toml")]) == 2
    assert f"{taken}: the meshes of {tmp_path / 'b.toml'} would go" in capsys.readouterr().err
    assert taken.read_bytes() == b"somebody's"
    assert not (tmp_path / "b.toml").exists()


def test_a_builtin_scene_as_a_scene_file_is_the_same_scene(tmp_path, capsys):
    target = tmp_path / "b.toml"
    assert cli.run(["convert", "builtin:cornell", str(target)]) == 0
    own, back = load("builtin:cornell"), load(target)
    assert capsys.readouterr().err == ""  # nothing is left out
    assert back.lights == own.lights
    assert back.triangle_count == own.triangle_count
    assert np.allclose(back.bounds, own.bounds)
    assert back.camera.position == own.camera.position


def test_of_a_builtin_scene_s_grids_it_is_said_that_they_are_left_out(tmp_path, capsys):
    target = tmp_path / "b.toml"
    assert cli.run(["convert", "builtin:smoke", str(target)]) == 0
    assert "note: A volume's density is no file: it is left out." in capsys.readouterr().err
    assert load(target).lights == load("builtin:smoke").lights


def test_xml_to_xml_takes_every_mesh_along(tmp_path):
    (tmp_path / "a.xml").write_text(
        '<scene version="3.0.0"><shape type="cube"/><shape type="sphere"/></scene>'
    )
    assert cli.run(["convert", str(tmp_path / "a.xml"), str(tmp_path / "b.xml")]) == 0
    before, after = load(tmp_path / "a.xml"), load(tmp_path / "b.xml")
    assert after.triangle_count == before.triangle_count > 12
    np.testing.assert_allclose(after.bounds, before.bounds, atol=1e-5)
