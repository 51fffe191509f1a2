"""[sky] in scene files: read, refused, and written again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from airlight.errors import SceneError
from airlight.scene.io import load
from airlight.scene.io.toml_text import scene_text
from airlight.scene.sun_sky import Sky, followed, with_sky

BOX = '[camera]\nposition = [0, 1, 4]\ntarget = [0, 0, 0]\n[[mesh]]\nshape = "box"\n'
PLACE = "latitude_deg = 48.1\nlongitude_deg = 11.6\ndate = 2026-06-21\ntime = 13:14:00\n"
FAR = "latitude_deg = 1\nlongitude_deg = {}\ndate = {}\ntime = 00:00:00\n"


def scene_of(folder: Path, sky: str, more: str = ""):
    file = folder / "scene.toml"
    file.write_text(f"{BOX}{more}[sky]\n{sky}")
    return load(file)


def test_angles(tmp_path):
    scene = scene_of(tmp_path, "elevation_deg = 20\nazimuth_deg = 90\nturbidity = 4\n")
    sky = Sky(20.0, 90.0, 4.0)
    assert scene.environment.sky == sky
    assert scene.lights == (sky.sun(),)
    assert scene.camera.exposure_stops is None


def test_place_and_time(tmp_path):
    scene = scene_of(tmp_path, f"{PLACE}utc_offset_h = 2\nnorth_deg = 30\n")
    sky = scene.environment.sky
    assert sky.elevation_deg == pytest.approx(65.33, abs=0.05)
    assert sky.azimuth_deg == pytest.approx(210.0, abs=1.0)


def test_lights_of_the_file_stay_and_keep_their_numbers(tmp_path):
    local_light = '[[light]]\ntype = "point"\nposition = [0, 2, 0]\nintensity = 5\n'
    moved = "[[light.key]]\ntime_s = 0\nposition = [0, 2, 0]\n"
    moved += "[[light.key]]\ntime_s = 1\nposition = [1, 2, 0]\n"
    scene = scene_of(tmp_path, "elevation_deg = 20\n", local_light + moved)
    assert [type(light).__name__ for light in scene.lights] == ["PointLight", "DirectionalLight"]
    assert scene.at(1.0).lights[0].position == (1.0, 2.0, 0.0)


@pytest.mark.parametrize(
    ("sky", "said"),
    [
        ("elevation_deg = 95\n", r"\[sky\]: sky elevation_deg"),
        ("elevation = 9\n", "Did you mean 'elevation_deg'"),
        ("latitude_deg = 48\n", "lack longitude_deg"),
        (PLACE + "elevation_deg = 3\n", "stands beside a place"),
        ('latitude_deg = 1\nlongitude_deg = 2\ndate = "today"\ntime = 12:00:00\n', "is no date"),
        (PLACE.replace("13:14:00", '"noon"'), "is no time"),
        (PLACE.replace("13:14", "00:14"), "it is night"),
        ("turbidity = 0.5\n", "turbidity"),
        (FAR.format(400, "2026-06-21"), r"\[sky\]: longitude"),
        (FAR.format(90, "0001-01-01"), "is no time at UTC"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, sky, said):
    with pytest.raises(SceneError, match=said):
        scene_of(tmp_path, sky)


def test_one_sky_at_a_time(tmp_path):
    with pytest.raises(SceneError, match=r"\[sky\] stands beside \[environment\]"):
        scene_of(tmp_path, "elevation_deg = 3\n", "[environment]\nradiance = 1\n")


def test_it_is_written_as_it_was_or_as_it_was_turned(tmp_path):
    scene = scene_of(tmp_path, f"{PLACE}utc_offset_h = 2\n")
    file = tmp_path / "scene.toml"
    text = scene_text(scene, scene, str(file), tmp_path)
    assert "date = 2026-06-21\ntime = 13:14:00\n" in text
    assert "[[light]]" not in text
    assert "[environment]" not in text
    again = tmp_path / "again.toml"
    again.write_text(text)
    assert load(again).lights == scene.lights
    # A hand turned the sun.
    turned = followed(with_sky(scene, Sky(15.0, 250.0, 3.0)))
    again.write_text(scene_text(turned, scene, str(file), tmp_path))
    assert load(again).environment.sky == Sky(15.0, 250.0, 3.0)


def test_a_model_under_a_sun_is_written_with_it(tmp_path):
    ply = tmp_path / "one.ply"
    ply.write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    )
    model = {"sun": "30,120"}
    scene = load(ply, **model)
    assert scene.lights == (Sky(30.0, 120.0).sun(),)
    assert scene.camera == replace(load(ply).camera, exposure_stops=None)  # framed as without
    again = tmp_path / "again.toml"
    again.write_text(scene_text(scene, scene, str(ply), tmp_path, model=model))
    assert load(again).environment.sky == Sky(30.0, 120.0)
    assert len(load(again).lights) == 1
