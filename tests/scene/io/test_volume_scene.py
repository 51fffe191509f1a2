"""A density grid alone: whitish smoke in daylight, seen whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.maths.blackbody import rec709
from airlight.scene.io import load
from airlight.scene.io.framing import framing_box
from airlight.scene.io.volume_scene import (
    DEPTH,
    FLAME,
    fitting_sigma_t,
    load_volume_scene,
)


def test_a_bare_grid_gets_a_camera_daylight_and_a_word_about_its_depth(tmp_path):
    density = np.zeros((4, 8, 6), np.float32)
    density[1:3, 2:6, 1:5] = 2.0
    np.save(tmp_path / "plume.npy", density)
    scene = load(tmp_path / "plume.npy")
    (volume,) = scene.volumes
    np.testing.assert_array_equal(volume.density, density)
    assert scene.name == "plume"
    assert len(scene.lights) == 1
    assert scene.environment is not None
    stops = scene.camera.exposure_stops
    assert stops is not None and stops < -2.0  # by the light that was added
    assert scene.camera == replace(framing_box(*scene.bounds), exposure_stops=stops)
    assert scene.warnings[-1] == (
        f"plume.npy says nothing about light: sigma_t = {volume.sigma_t[0]:g} m^-1 and albedo = "
        "0.9 were chosen; a scene file with [[volume]] sets them"
    )


def test_its_denser_parts_are_six_deep():
    # 4 m of density .5 along x, the longest side
    density = np.full((3, 3, 3), 0.5, np.float32)
    assert fitting_sigma_t(density, ((0, 0, 0), (4, 1, 2))) == DEPTH / 2.0
    assert fitting_sigma_t(0.0 * density, ((0, 0, 0), (4, 1, 2))) == 1.0


def test_a_box_is_seen_whole():
    low, high = np.zeros(3), np.array([4.0, 2.0, 1.0])
    camera = framing_box(low, high)
    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, 8).T
    offset = corners - camera.position
    forward = np.subtract(camera.target, camera.position)
    angles = np.arccos(offset @ forward / np.linalg.norm(offset, axis=1) / np.linalg.norm(forward))
    # Within the circle around a 4:3 image, and beyond the one in it.
    half = np.tan(np.radians(camera.fov_y_deg) / 2)
    assert np.arctan(half) < angles.max() < np.arctan(half * 5 / 3)


def test_air_is_seen_before_the_sky():
    """All of the view lies above the horizon: no ground is behind the box."""
    camera = framing_box(np.array([0.0, 300.0, 0.0]), np.array([3000.0, 2300.0, 3000.0]))
    x, y, z = np.subtract(camera.target, camera.position)
    assert np.degrees(np.arctan2(y, np.hypot(x, z))) > camera.fov_y_deg / 2


def test_a_damaged_grid_is_one_message(tmp_path):
    (tmp_path / "a.npy").write_bytes(b"no")
    with pytest.raises(SceneError, match=r"a\.npy"):
        load_volume_scene(tmp_path / "a.npy")


@pytest.mark.parametrize("unit", [1.0, 1000.0])
def test_a_bare_grid_with_temperatures_is_a_fire(tmp_path, unit):
    """In kelvin, or from 0 to 2 as simulations have them: the hottest voxels glow alike."""
    density = np.ones((4, 8, 6), np.float32)
    kelvin = np.linspace(0.0, 1900.0, density.size, dtype=np.float32).reshape(density.shape)
    np.savez(tmp_path / "fire.npz", density=density, temperature=kelvin / unit)
    scene = load(tmp_path / "fire.npz")
    emission = scene.volumes[0].emission
    expected = rec709(1900.0)
    np.testing.assert_allclose(emission.values[-1, -1, -1], expected, rtol=2e-3, atol=0.1)
    # A tenth of the two metres that a grid without a box is long.
    assert emission.peak * emission.radiance[0] * 0.2 == pytest.approx(FLAME, rel=0.01)
    assert 'temperature_grid = "temperature"' in " ".join(scene.warnings)
    assert ("temperature_scale" in " ".join(scene.warnings)) == (unit != 1.0)
    assert not scene.lights


def test_a_bare_grid_with_flames_glows_orange_and_a_cold_one_does_not(tmp_path):
    density = np.ones((4, 8, 6), np.float32)
    flame = np.random.default_rng(1).random(density.shape, dtype=np.float32)
    np.savez(tmp_path / "a.npz", density=density, flame=flame)
    emission = load(tmp_path / "a.npz").volumes[0].emission
    assert emission.radiance[0] > emission.radiance[1] > emission.radiance[2] > 0.0
    np.savez(tmp_path / "b.npz", density=density, flame=0.0 * flame)
    cold = load(tmp_path / "b.npz")
    assert cold.volumes[0].emission is None
    assert "no fire that is seen" in " ".join(cold.warnings)
