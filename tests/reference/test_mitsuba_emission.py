"""What media emit as Mitsuba's glowing balls: their power, their places, what is said."""

from __future__ import annotations

import numpy as np

from airlight.reference.mitsuba import write_mitsuba
from airlight.reference.mitsuba_emission import BALLS, emission_balls
from airlight.reference.mitsuba_lights import has_glow
from airlight.reference.mitsuba_scene import VISIBLE_ENVIRONMENT
from airlight.scene import Emission, Environment, Medium, Scene, Volume

BOX = ((-1.0, 0.0, -0.5), (1.0, 3.0, 1.5))
GLOW = (4.0, 2.0, 0.5)


def read(balls: list) -> tuple[np.ndarray, np.ndarray]:
    """Centres (n, 3), and intensities (n, 3), W sr^-1."""
    points, light = [], []
    for ball in balls:
        centre = ball.find("point")
        points.append([float(centre.get(axis)) for axis in "xyz"])
        radius = float(ball.find("float").get("value"))
        radiance = [float(c) for c in ball.find("emitter/rgb").get("value").split(",")]
        light.append(np.pi * radius**2 * np.array(radiance))
    return np.array(points), np.array(light)


def test_a_grid_has_its_power_and_its_centre() -> None:
    rng = np.random.default_rng(1)
    grid = rng.random((9, 8, 7), dtype=np.float32) ** 6
    volume = Volume((1.0,) * 3, np.ones_like(grid), bounds=BOX, emission=Emission(GLOW, grid))
    notes: list[str] = []
    points, light = read(emission_balls(Scene(volumes=(volume,)), notes))
    assert len(points) == BALLS
    assert "glowing balls" in notes[0]
    expected = np.array(GLOW) * float(grid.mean(dtype=np.float64)) * 12.0
    np.testing.assert_allclose(light.sum(axis=0), expected, rtol=1e-5)
    assert (points > BOX[0]).all() and (points < BOX[1]).all()
    axes = [(np.arange(n) + 0.5) / n for n in grid.shape]
    z, y, x = np.meshgrid(*axes, indexing="ij")
    mean = [np.average(a, weights=grid) for a in (x, y, z)]
    centre = np.array(BOX[0]) + np.array(mean) * np.subtract(BOX[1], BOX[0])
    # 400 random draws of a box of 3 m: 4 deviations of their mean.
    np.testing.assert_allclose(points.mean(axis=0), centre, atol=4.0 * 0.29 * 3.0 / 20.0)


def test_nothing_is_written_of_what_is_dark_and_a_medium_is_said_to_be_left_out() -> None:
    dark = Volume((1.0,) * 3, shape="box", emission=Emission((0.0, 0.0, 0.0)))
    notes: list[str] = []
    assert emission_balls(Scene(volumes=(dark,)), notes) == []
    assert notes == []
    assert emission_balls(Scene(medium=Medium((0.1,) * 3, emission=GLOW)), notes) == []
    assert "[medium] is left out" in notes[0]


def test_a_glowing_volume_keeps_an_invisible_environment_shown(tmp_path) -> None:
    """Mitsuba hides all emitters or none: what volumes emit must be seen."""
    sky = Environment(radiance=(1.0, 1.0, 1.0), visible=False)
    for radiance, is_told in ((GLOW, True), ((0.0, 0.0, 0.0), False)):
        volume = Volume((1.0,) * 3, shape="box", emission=Emission(radiance))
        scene = Scene(volumes=(volume,), environment=sky)
        assert has_glow(scene) == is_told
        notes = write_mitsuba(scene, tmp_path / f"{is_told}.xml")
        assert (VISIBLE_ENVIRONMENT in notes) == is_told
        assert ("hide_emitters" in (tmp_path / f"{is_told}.xml").read_text()) != is_told
    dark = Volume((1.0,) * 3, np.zeros((2, 2, 2), np.float32), emission=Emission(GLOW))
    assert not has_glow(Scene(volumes=(dark,), environment=sky))
