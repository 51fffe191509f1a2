"""`airlight info`: scenes, images and density grids, for people and machines."""

from __future__ import annotations

import json

import numpy as np

from airlight.app import cli
from airlight.app.info import scene_facts
from airlight.scene import Environment, Scene
from airlight.scene.image import Image

SCENE = """
[camera]
position = [0, 0, 5]
target = [0, 0, 0]
[[mesh]]
shape = "box"
[[light]]
type = "point"
position = [0, 2, 0]
intensity = 3
[medium]
sigma_t = 0.5
[technique.lpv]
resolution = 16
"""


def facts(capsys, *arguments: str) -> dict:
    assert cli.run(["info", *arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_scene_as_json(tmp_path, capsys):
    (tmp_path / "a.toml").write_text(SCENE)
    told = facts(capsys, str(tmp_path / "a.toml"))
    assert told["kind"] == "scene"
    assert (told["meshes"], told["triangles"]) == (1, 12)
    assert told["bounds_m"] == [[-0.5] * 3, [0.5] * 3]
    assert told["lights"] == [{"type": "point", "position": [0, 2, 0], "intensity": [3, 3, 3]}]
    assert told["medium"]["sigma_t"] == [0.5, 0.5, 0.5]
    assert told["techniques"] == {"lpv": {"resolution": 16}}
    assert told["environment"] is None


def test_a_scene_for_people(tmp_path, capsys):
    (tmp_path / "a.toml").write_text(SCENE)
    assert cli.run(["info", str(tmp_path / "a.toml")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "triangles: 12" in lines
    assert "  type point, position (0, 2, 0), intensity (3, 3, 3)" in lines
    assert "volumes: none" in lines
    assert "environment: none" in lines


def test_an_image(tmp_path, capsys):
    pixels = np.full((2, 3, 3), 0.5, np.float32)
    Image(pixels, layers={"depth": pixels[..., 0]}).save(tmp_path / "a.exr")
    told = facts(capsys, str(tmp_path / "a.exr"))
    assert told["size_px"] == [3, 2]
    assert told["layers"] == ["depth"]
    np.testing.assert_allclose(told["mean_radiance"], 0.5)


def test_a_density_grid(tmp_path, capsys):
    np.save(tmp_path / "a.npy", np.arange(24.0).reshape(2, 3, 4))
    told = facts(capsys, str(tmp_path / "a.npy"))
    assert told["size_zyx"] == [2, 3, 4]
    assert told["density"] == {"lowest": 0.0, "mean": 11.5, "highest": 23.0}


def test_a_volume_that_glows(tmp_path, capsys):
    grids = {"density": np.ones((2, 3, 4)), "flame": np.arange(24.0).reshape(2, 3, 4)}
    np.savez(tmp_path / "a.npz", **grids)
    text = (
        '[[volume]]\nfile = "a.npz"\nsigma_t = 1\nemission_grid = "flame"\nemission = [2, 1, 0]\n'
    )
    (tmp_path / "a.toml").write_text(text)
    told = facts(capsys, str(tmp_path / "a.toml"))
    assert told["volumes"][0]["emission_peak"] == [46.0, 23.0, 0.0]
    assert all(light["type"] == "samples" for light in told["surfaces_that_light"])


def test_what_cannot_be_read(tmp_path, capsys):
    for name in ("gone.toml", "gone.exr", "gone.npy", "gone.obj", "gone"):
        assert cli.run(["info", str(tmp_path / name)]) == 2
        err = capsys.readouterr().err
        assert err.startswith(f"error: {tmp_path / name}")
        assert err.count("\n") == 1


def test_when_a_scene_moves(tmp_path, capsys):
    first, last = (
        f"[[camera.key]]\ntime_s = {t}\nposition = [{x}, 0, 5]\n" for t, x in ((1, 0), (3.5, 1))
    )
    keys = first + last
    moving = SCENE.replace("[[mesh]]", f"{keys}[animation]\nstart_s = 1\nfps = 10\n[[mesh]]")
    (tmp_path / "a.toml").write_text(moving)
    told = facts(capsys, str(tmp_path / "a.toml"))["animation"]
    assert told == {
        "start_s": 1.0,
        "end_s": 3.5,
        "fps": 10.0,
        "loop": False,
        "frames": 25,
        "moving": ["camera"],
    }
    assert cli.run(["info", str(tmp_path / "a.toml")]) == 0
    said = capsys.readouterr().out
    assert "animation: start_s 1, end_s 3.5, fps 10, loop False, frames 25, moving (camera)" in said
    (tmp_path / "b.toml").write_text(SCENE)
    assert facts(capsys, str(tmp_path / "b.toml"))["animation"] is None


def test_a_sun_is_among_the_lights_and_none_for_images(tmp_path, capsys):
    (tmp_path / "a.toml").write_text(SCENE)
    told = facts(capsys, str(tmp_path / "a.toml"), "--sun", "35,135")
    assert any(light["type"] == "directional" for light in told["lights"])
    np.save(tmp_path / "a.npy", np.ones((2, 2, 2), np.float32))
    assert facts(capsys, str(tmp_path / "a.npy"), "--sun", "35,135")["kind"] == "density grid"
    Image(np.ones((2, 2, 3), np.float32)).save(tmp_path / "a.exr")
    for option in (["--sun", "35,135"], ["--ground"]):
        assert cli.run(["info", str(tmp_path / "a.exr"), *option]) == 2
        assert f"a.exr: {option[0]} is for scenes" in capsys.readouterr().err


def test_the_sun_of_an_environment_map_is_told():
    pixels = np.full((256, 512, 3), 0.5, np.float32)
    pixels[60, 100] = 20_000.0
    told = scene_facts(Scene(environment=Environment(map=pixels)))
    (sun,) = told["sun_in_environment"]
    assert sun["type"] == "directional"
    assert scene_facts(Scene(environment=Environment()))["sun_in_environment"] == []


def test_area_lights_are_told_with_what_their_shape_has(tmp_path, capsys):
    text = '[[mesh]]\nshape = "box"\n'
    for shape, more in (("rectangle", "size = [1, 2]"), ("sphere", "radius = 2")):
        text += f'[[light]]\ntype = "area"\nshape = "{shape}"\n{more}\nposition = [0, 3, 0]\n'
        text += "radiance = 3\n"
    (tmp_path / "a.toml").write_text(text)
    assert cli.run(["info", str(tmp_path / "a.toml"), "--json"]) == 0
    rectangle, sphere = json.loads(capsys.readouterr().out)["lights"]
    assert rectangle["size"] == [1.0, 2.0] and "radius" not in rectangle
    assert sphere["radius"] == 2.0 and not {"size", "up"} & set(sphere)
