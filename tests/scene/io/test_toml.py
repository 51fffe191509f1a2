"""Scene files: every key lands where it should; every mistake gets one exact message."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.toml import load_toml
from airlight.scene.io.toml_text import scene_text
from airlight.scene.lights import DirectionalLight, PointLight, SpotLight

BOX = '[[mesh]]\nshape = "box"\n'
CAMERA = "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n"
SUN = '[[light]]\ntype = "directional"\ndirection = [0, -2, 0]\nirradiance = 3\n'


@pytest.fixture
def load(tmp_path: Path):
    """Loads text as a scene file."""

    def load_text(text: str):
        (tmp_path / "room.toml").write_text(text, encoding="utf-8")
        return load_toml(tmp_path / "room.toml")

    return load_text


@pytest.fixture
def message(load, tmp_path: Path):
    """The error that a text gives, without the folder it lies in."""

    def message_of(text: str) -> str:
        with pytest.raises(SceneError) as caught:
            load(text)
        return str(caught.value).replace(f"{tmp_path}/", "")

    return message_of


def test_every_key_of_the_format(load, tmp_path):
    np.save(tmp_path / "smoke.npy", np.ones((2, 3, 4), np.float32))
    scene = load("""
        [camera]
        position = [0.3, 1.6, 7.6]
        target = [0.2, 1.1, 2.5]
        up = [0, 2, 0]
        fov_y_deg = 60.0
        exposure_stops = -1
        [[mesh]]
        shape = "box"
        translate = [1, 2, 3]
        rotate_deg = [0, 90, 0]
        scale = 2.0
        base_color = [0.1, 0.2, 0.3]
        roughness = 0.4
        metallic = 1
        emission = 5
        [[mesh]]
        shape = "plane"
        matrix = [1, 0, 0, 7,  0, 1, 0, 8,  0, 0, 1, 9,  0, 0, 0, 1]
        [[light]]
        type = "directional"
        direction = [0, -2, 0]
        irradiance = [30, 27, 22]
        [[light]]
        type = "point"
        position = [0, 2, 0]
        intensity = 3
        [[light]]
        type = "spot"
        position = [0, 2, 0]
        direction = [0, -1, 0]
        intensity = 8.0
        inner_deg = 10
        outer_deg = 25
        [environment]
        radiance = [1, 2, 3]
        scale = 0.5
        rotation_deg = 45
        visible = false
        [medium]
        sigma_s = 0.12
        sigma_a = [0.04, 0.0, 0.12]
        g = 0.3
        bounds = [[-4.2, -1.5, -3.0], [4.6, 5.0, 9.4]]
        [[volume]]
        file = "smoke.npy"
        bounds = [[-1, -1, -1], [1, 1, 2]]
        sigma_t = 10.0
        albedo = [0.9, 0.95, 0.98]
        g = 0.85
        [[volume]]
        shape = "sphere"
        sigma_t = 1
        [technique.lpv-scatter]
        resolution = 32
        iterations = 8
    """)
    assert scene.name == "room"
    assert scene.camera.position == (0.3, 1.6, 7.6)
    assert scene.camera.up == (0.0, 1.0, 0.0)
    assert (scene.camera.fov_y_deg, scene.camera.exposure_stops) == (60.0, -1.0)

    box, plane = scene.meshes
    assert box.material.base_color == (0.1, 0.2, 0.3)
    assert (box.material.roughness, box.material.metallic) == (0.4, 1.0)
    assert box.material.emission == (5.0, 5.0, 5.0)
    np.testing.assert_allclose(
        box.world_from_object, [[0, 0, 2, 1], [0, 2, 0, 2], [-2, 0, 0, 3], [0, 0, 0, 1]], atol=1e-15
    )
    np.testing.assert_array_equal(plane.world_from_object[:3, 3], [7, 8, 9])

    sun, point, spot = scene.lights
    assert sun == DirectionalLight((0, -1, 0), (30, 27, 22))
    assert point == PointLight((0, 2, 0), (3, 3, 3))
    assert spot == SpotLight((0, 2, 0), (0, -1, 0), (8, 8, 8), 10, 25)

    sky = scene.environment
    assert (sky.radiance, sky.scale, sky.rotation_deg, sky.visible) == ((1, 2, 3), 0.5, 45, False)

    air = scene.medium
    np.testing.assert_allclose(air.sigma_t, [0.16, 0.12, 0.24])
    np.testing.assert_allclose(air.albedo, [0.75, 1.0, 0.5])
    assert air.g == (0.3, 0.3, 0.3)
    assert air.bounds == ((-4.2, -1.5, -3.0), (4.6, 5.0, 9.4))

    smoke, ball = scene.volumes
    assert smoke.density.shape == (2, 3, 4)
    assert smoke.bounds == ((-1, -1, -1), (1, 1, 2))
    assert (smoke.sigma_t, smoke.albedo) == ((10, 10, 10), (0.9, 0.95, 0.98))
    assert (ball.shape, ball.density) == ("sphere", None)
    assert scene.settings == {"lpv-scatter": {"resolution": 32, "iterations": 8}}
    assert scene.warnings == ()


def test_rotation_is_about_x_then_y_then_z(load):
    scene = load(CAMERA + SUN + BOX + "rotate_deg = [90, 90, 0]")
    # +Y turns to +Z about X, and +Z to +X about Y.
    np.testing.assert_allclose(
        scene.meshes[0].world_from_object[:3, :3] @ [0, 1, 0], [1, 0, 0], atol=1e-15
    )


def test_scale_comes_before_rotation(load):
    scene = load(CAMERA + SUN + BOX + "rotate_deg = [0, 0, 90]\nscale = [3, 1, 1]")
    low, high = scene.meshes[0].world_bounds
    np.testing.assert_allclose(high - low, [1, 3, 1], atol=1e-12)


def test_lights_of_the_file_leave_the_background_black(load):
    assert load(CAMERA + BOX + SUN).environment is None
    assert load(CAMERA + BOX + "emission = 10").lights == ()


def test_a_scene_without_light_gets_sun_and_sky(load):
    scene = load(CAMERA + BOX)
    assert scene.lights
    assert scene.environment is not None


def test_a_scene_without_camera_gets_one_that_frames_it(load):
    scene = load(SUN + BOX + "translate = [100, 0, 0]")
    assert scene.camera.target[0] == pytest.approx(100.0, abs=1.0)


def test_an_environment_map_is_read(load, tmp_path):
    from PIL import Image

    Image.new("RGB", (8, 4), (255, 255, 255)).save(tmp_path / "white.png")
    scene = load(CAMERA + BOX + '[environment]\nfile = "white.png"')
    assert scene.environment.map.shape == (4, 8, 3)
    np.testing.assert_allclose(scene.environment.map, 1.0)
    assert scene.environment.source == "white.png"
    assert "an 8-bit image used as light" in scene.warnings[0]


SYNTAX = [
    ("[camera\n", "room.toml:1:8: is not TOML: Expected ']' at the end of a table declaration"),
    ("[camera]\nfov_y_deg =\n", "room.toml:2:12: is not TOML: Invalid value"),
]

MISTAKES = [
    ("[camra]\n", "unknown table 'camra'. Did you mean 'camera'?"),
    (
        "fov = 3\n",
        "unknown key outside any table, 'fov'. Known: animation, camera, environment, "
        "light, medium, mesh, sky, technique, volume.",
    ),
    ("[mesh]\nshape = 'box'\n", "'mesh' must be written as a [[mesh]] table"),
    ("[[camera]]\n", "'camera' must be written as a [camera] table"),
    ("camera = 3\n", "[camera] must be a table of keys, not 3"),
    (
        BOX + "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\nfov_y = 3\n",
        "unknown key 'fov_y' in [camera]. Did you mean 'fov_y_deg'?",
    ),
    (
        BOX + "[camera]\nposition = [0, 0, 5]\n",
        "[camera] has no target. It is the point it looks at (vector, m).",
    ),
    (BOX + CAMERA + "fov_y_deg = 200\n", "[camera]: fov_y_deg = 200 is outside [0.1, 179]"),
    (BOX + CAMERA + 'fov_y_deg = "wide"\n', "[camera]: fov_y_deg must be a number, not 'wide'"),
    (
        BOX + "[camera]\nposition = [0, 0, 0]\ntarget = [0, 0, 0]\n",
        "[camera]: camera position and target are the same point",
    ),
    (SUN, "there is nothing to see: no [[mesh]], [[volume]] or [medium]"),
    ("", "there is nothing to see: no [[mesh]], [[volume]] or [medium]"),
    ("[[mesh]]\n", "[[mesh]] 1 needs either a file or a shape"),
    (BOX + 'file = "a.obj"\n', "[[mesh]] 1 needs either a file or a shape"),
    (
        BOX + '[[mesh]]\nfile = "gone.obj"\n',
        "[[mesh]] 2: file 'gone.obj' does not exist. Paths are relative to the scene file.",
    ),
    (
        '[[mesh]]\nfile = "room.toml"\n',
        "[[mesh]] 1: file 'room.toml' is not a mesh file. "
        "Known endings: .obj, .glb, .gltf, .ply, .stl, .usd, .usda, .usdc, .usdz.",
    ),
    (
        '[[mesh]]\nshape = "sphre"\n',
        "[[mesh]] 1: shape = 'sphre' is unknown. Did you mean 'sphere'?",
    ),
    (BOX + "base_color = [0.5, 2, 0]\n", "[[mesh]] 1: base_color = [0.5, 2.0, 0.0] is above 1"),
    (BOX + "base_color = [0.5, 2]\n", "[[mesh]] 1: base_color must be three numbers, not [0.5, 2]"),
    (BOX + "roughness = true\n", "[[mesh]] 1: roughness must be a number, not True"),
    (BOX + "roughness = nan\n", "[[mesh]] 1: roughness is nan, it must be finite"),
    (
        BOX + "scale = 0\n",
        "[[mesh]] 1: scale = [0.0, 0.0, 0.0] flattens the mesh: no factor may be zero",
    ),
    (BOX + "matrix = [1, 2, 3]\n", "[[mesh]] 1: matrix must be 16 numbers, row major"),
    (
        BOX + "matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 7,8,9,1]\n",
        "[[mesh]] 1: matrix ends with the row [7.0, 8.0, 9.0, 1.0], it must be [0, 0, 0, 1]. "
        "Rows come first: the translation is the 4th, 8th and 12th number.",
    ),
    (
        BOX + "matrix = [1,0,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1]\n",
        "[[mesh]] 1: matrix flattens the mesh: its determinant is zero",
    ),
    (
        BOX + "scale = 2\nmatrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n",
        "[[mesh]] 1 has matrix beside scale. Use matrix alone, or translate, rotate_deg and scale.",
    ),
    (
        BOX + "[[light]]\nposition = [0, 1, 0]\n",
        '[[light]] 1 has no type. It is "directional", "point", "spot", "area" or "points".',
    ),
    (
        BOX + '[[light]]\ntype = "sun"\n',
        "[[light]] 1: type = 'sun' is unknown. Known: area, directional, point, points, spot.",
    ),
    (
        BOX + SUN + SUN + "intensity = 3\n",
        "unknown key 'intensity' in [[light]] 2 (directional). "
        "Known: between, direction, irradiance, type.",
    ),
    (
        BOX + '[[light]]\ntype = "point"\nposition = [0, 1, 0]\n',
        "[[light]] 1 (point) has no intensity. It is intensity (of a spot: on its axis) "
        "(colour, W sr^-1).",
    ),
    (
        BOX + '[[light]]\ntype = "point"\nposition = [0, 1, 0]\nintensity = -1\n',
        "[[light]] 1: intensity = [-1.0, -1.0, -1.0] is negative",
    ),
    (
        BOX + '[[light]]\ntype = "directional"\ndirection = [0, 0, 0]\nirradiance = 1\n',
        "[[light]] 1: direction is zero, it must point somewhere",
    ),
    (
        BOX + '[[light]]\ntype = "spot"\nposition = [0, 1, 0]\ndirection = [0, -1, 0]\n'
        "intensity = 1\ninner_deg = 40\n",
        "[[light]] 1: inner_deg = 40 is above outer_deg = 30",
    ),
    (
        BOX + '[environment]\nfile = "sky.exr"\nradiance = 1\n',
        "[environment] has both a file and a radiance. Use one of them.",
    ),
    (
        BOX + '[environment]\nfile = "sky.exr"\n',
        "[environment]: file 'sky.exr' does not exist. Paths are relative to the scene file.",
    ),
    (
        BOX + '[environment]\nfile = "."\n',
        "[environment]: file '.' is a folder, not a file. Paths are relative to the scene file.",
    ),
    (
        BOX + "[environment]\nscale = -1\n",
        "[environment]: environment scale = -1 is outside [0, 1e+15]",
    ),
    (BOX + "[environment]\nvisible = 1\n", "[environment]: visible must be true or false, not 1"),
    (
        "[medium]\nsigma_s = 1\nalbedo = 0.5\n",
        "[medium] mixes sigma_s with albedo. Use sigma_t and albedo, or sigma_s and sigma_a.",
    ),
    (
        "[medium]\nsigma_t = 1\nsigma_a = 0.5\n",
        "[medium] mixes sigma_a with sigma_t. Use sigma_t and albedo, or sigma_s and sigma_a.",
    ),
    (
        "[medium]\nalbedo = 0.5\n",
        "[medium] has no sigma_t. Use sigma_t and albedo, or sigma_s and sigma_a.",
    ),
    ("[medium]\nsigma_t = 1\ng = 1\n", "[medium]: g = [1.0, 1.0, 1.0] must lie in (-1, 1)"),
    (
        "[medium]\nsigma_t = 1\nbounds = [[0, 0, 0], [1, 0, 1]]\n",
        "[medium]: bounds is empty: [0.0, 0.0, 0.0] to [1.0, 0.0, 1.0]",
    ),
    ("[[volume]]\nsigma_t = 1\n", "[[volume]] 1 needs either a file, a sequence or a shape"),
    (
        '[[volume]]\nshape = "box"\nsigma_t = 1\ngrid = "density"\n',
        "[[volume]] 1: grid belongs to a file, not to a shape",
    ),
    (
        '[[volume]]\nshape = "box"\nalbedo = 1\n',
        "[[volume]] 1 has no sigma_t. Use sigma_t and albedo, or sigma_s and sigma_a.",
    ),
    (
        '[[volume]]\nfile = "smoke.vol"\nsigma_t = 1\n',
        "[[volume]] 1: file 'smoke.vol' does not exist. Paths are relative to the scene file.",
    ),
    ("technique = 3\n", "'technique' must be written as [technique.NAME] tables"),
    (
        BOX + "[technique]\nresolution = 3\n",
        "[technique]: resolution stands outside a "
        "technique's table. Write it under [technique.NAME], such as [technique.lpv] "
        "resolution = ...",
    ),
    (BOX + f"roughness = {'9' * 400}\n", "[[mesh]] 1: roughness is too large"),
]


@pytest.mark.parametrize(("text", "expected"), MISTAKES, ids=[m for _, m in MISTAKES])
def test_a_mistake_gets_one_exact_message(message, text, expected):
    assert message(text) == f"room.toml: {expected}"


@pytest.mark.parametrize(("text", "expected"), SYNTAX, ids=["table", "value"])
def test_a_syntax_error_names_line_and_column(message, text, expected):
    assert message(text).startswith(expected)


def test_text_that_is_not_utf8(tmp_path):
    (tmp_path / "bad.toml").write_bytes(b"# caf\xe9\n")
    with pytest.raises(SceneError, match=r"bad\.toml: is not UTF-8 text \(byte 5\)"):
        load_toml(tmp_path / "bad.toml")


def test_nesting_without_end(message):
    assert message("x = " + "[" * 100_000).startswith("room.toml")


def test_a_missing_scene_file(tmp_path):
    with pytest.raises(SceneError, match=r"gone\.toml: file not found"):
        load_toml(tmp_path / "gone.toml")


def test_a_bad_file_inside_speaks_for_itself(load, tmp_path):
    np.save(tmp_path / "smoke.npy", np.ones((2, 3), np.float32))
    with pytest.raises(SceneError, match=r"smoke\.npy: has shape \(2, 3\)"):
        load('[[volume]]\nfile = "smoke.npy"\nsigma_t = 1\n')


def test_a_volume_without_a_place_warns(load, tmp_path):
    np.save(tmp_path / "smoke.npy", np.ones((2, 4, 4), np.float32))
    scene = load('[[volume]]\nfile = "smoke.npy"\nsigma_t = 1\n' + SUN + CAMERA)
    assert scene.volumes[0].bounds == ((-1, -1, -0.5), (1, 1, 0.5))
    assert "smoke.npy does not say where it is" in scene.warnings[0]


def test_exposure_may_come_from_the_image(tmp_path):
    file = tmp_path / "s.toml"
    camera = "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\nexposure_stops = {}\n"
    file.write_text(camera.format('"auto"') + '[[mesh]]\nshape = "box"\n')
    scene = load_toml(file)
    assert scene.camera.exposure_stops is None
    assert 'exposure_stops = "auto"' in scene_text(scene, scene, str(file), tmp_path)
    file.write_text(camera.format('"bright"') + '[[mesh]]\nshape = "box"\n')
    with pytest.raises(SceneError, match='exposure_stops must be a number or "auto"'):
        load_toml(file)


def test_emission_is_a_scene_file_s_only_light_and_dim_emission_is_said(tmp_path):
    file = tmp_path / "s.toml"
    file.write_text('[[mesh]]\nshape = "box"\nemission = 0.5\n')
    scene = load_toml(file)
    assert not scene.lights
    assert any("dim (radiance 0.5)" in w for w in scene.warnings)
    file.write_text('[[mesh]]\nshape = "box"\nemission = 50.0\n')
    assert not load_toml(file).lights
