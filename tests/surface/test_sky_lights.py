"""The environment as directional lights."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene import Environment
from airlight.surface import sky
from airlight.surface.sky import EnvironmentTexture, environment_map, sky_lights

RNG = np.random.default_rng(5)
MAP = (RNG.random((16, 32, 3)) ** 4 * 10.0).astype(np.float32)


def integral(radiance):
    """(3,) the sum over texels of radiance times solid angle, by the rows' bounds in cosine."""
    height, width = radiance.shape[:2]
    row = -np.diff(np.cos(np.linspace(0.0, np.pi, height + 1))) * 2.0 * np.pi / width
    return (radiance.astype(np.float64) * row[:, None, None]).sum(axis=(0, 1))


def total(lights):
    return np.sum([light.irradiance for light in lights], axis=0)


@pytest.mark.parametrize("count", [1, 7, 64])
def test_irradiances_sum_to_the_integral_of_the_map(count):
    lights = sky_lights(Environment(map=MAP, scale=1.5), count)
    assert len(lights) <= count
    np.testing.assert_allclose(total(lights), 1.5 * integral(MAP), rtol=1e-4)


def test_fine_maps_keep_their_light():
    fine = np.kron(MAP, np.ones((16, 16, 1), np.float32))
    # averaging blocks of texels of unequal solid angle shifts a little of it
    np.testing.assert_allclose(
        total(sky_lights(Environment(map=fine), 32)), integral(fine), rtol=5e-3
    )


@pytest.mark.parametrize("degrees", [2.0, 10.0, 30.0])
def test_a_disc_s_spread_is_its_radius(degrees):
    rows = 512
    polar = (np.arange(rows) + 0.5) * 180.0 / rows
    pixels = np.where(polar < degrees, 1.0, 0.0)[:, None, None] * np.ones((rows, 2 * rows, 3))
    (light,) = sky_lights(Environment(map=pixels.astype(np.float32)), 1)
    # the map that is partitioned has rows of 2.8 degrees
    assert np.degrees(np.arctan(light.spread)) == pytest.approx(degrees, abs=1.5)


def test_a_constant_environment_is_four_pi():
    lights = sky_lights(Environment(radiance=(1, 2, 3)), 64)
    np.testing.assert_allclose(total(lights), np.array([1, 2, 3]) * 4.0 * np.pi, rtol=1e-4)


@pytest.mark.parametrize(
    ("texel", "towards"),
    [((8, 0), (0, 0, -1)), ((8, 8), (1, 0, 0)), ((8, 16), (0, 0, 1)), ((8, 24), (-1, 0, 0))],
)
@pytest.mark.parametrize("rotation_deg", [0.0, 90.0, -37.0])
def test_a_bright_texel_shines_from_where_it_is(texel, towards, rotation_deg):
    height, width = 16, 32
    pixels = np.zeros((height, width, 3), np.float32)
    # four texels about (u, v) = texel / size, so that their centre is the direction itself
    for row in (-1, 0):
        for column in (-1, 0):
            pixels[texel[0] + row, (texel[1] + column) % width] = 1.0
    (light,) = sky_lights(Environment(map=pixels, rotation_deg=rotation_deg), 1)
    angle = np.radians(rotation_deg)  # counter-clockwise seen from above: +x turns towards -z
    x, y, z = towards
    turned = (x * np.cos(angle) + z * np.sin(angle), y, z * np.cos(angle) - x * np.sin(angle))
    np.testing.assert_allclose(light.direction, -np.array(turned), atol=1e-6)


def test_turning_the_map_turns_the_light_and_keeps_its_sum():
    still, turned = (
        sky_lights(Environment(map=MAP, rotation_deg=angle), 64) for angle in (0.0, 180.0)
    )
    np.testing.assert_allclose(total(turned), total(still), rtol=1e-9)

    def moment(lights):
        return np.sum([np.outer(light.irradiance, light.direction) for light in lights], axis=0)

    scale = total(still).max()
    np.testing.assert_allclose(moment(turned), moment(still) * [-1.0, 1.0, -1.0], atol=0.02 * scale)


@pytest.mark.parametrize(
    ("environment", "count"),
    [
        (None, 8),
        (Environment(radiance=(0, 0, 0)), 8),
        (Environment(), 0),
        (Environment(scale=0.0), 8),
    ],
)
def test_a_black_sky_has_no_lights(environment, count):
    assert sky_lights(environment, count) == []


def test_the_background_is_the_map_in_half_floats(gpu, owned):
    bright = MAP.copy()
    bright[0, 0] = 1e6
    background = EnvironmentTexture(gpu, Environment(map=bright, scale=2.0))
    owned(background.texture)
    read = background.texture.read()[..., :3].astype(np.float64)
    assert read[0, 0, 0] == 65504.0
    np.testing.assert_allclose(read[1:], 2.0 * MAP[1:], rtol=1e-3, atol=1e-6)


def test_another_map_of_the_same_size_takes_the_place_of_the_first(gpu, owned):
    background = EnvironmentTexture(gpu, Environment(map=MAP))
    texture = owned(background.texture)
    assert background.take(Environment(map=3.0 * MAP, rotation_deg=90.0))
    assert background.texture is texture and background.rotation == np.pi / 2
    read = texture.read()[..., :3].astype(np.float64)
    np.testing.assert_allclose(read, np.minimum(3.0 * MAP, 65504.0), rtol=1e-3, atol=1e-6)
    assert background.take(Environment(map=background._shown.map, rotation_deg=30.0))
    assert not background.take(Environment(map=MAP[::2]))
    assert not background.take(None), "its map has one texel"


def test_a_sky_that_changes_in_two_scenes_gets_a_texture_of_its_own_once(gpu, monkeypatch):
    """No map is looked at byte by byte, nor any texture made, in the frames after that."""
    scope = gpu.scope()
    both = [EnvironmentTexture(scope, Environment(map=MAP)) for _ in range(2)]
    assert both[0].texture is both[1].texture
    for seen in both:
        assert seen.take(Environment(map=2.0 * MAP))
    own = [seen.texture for seen in both]
    assert own[0] is not own[1]
    monkeypatch.setattr(sky, "array_digest", None)
    monkeypatch.setattr(sky, "Texture", None)
    for k, seen in enumerate(both):
        assert seen.take(Environment(map=(3.0 + k) * MAP))
        assert seen.texture is own[k]
    for k, seen in enumerate(both):
        read = seen.texture.read()[..., :3].astype(np.float64)
        np.testing.assert_allclose(read, (3.0 + k) * MAP, rtol=1e-3, atol=1e-6)
    scope.release()


def test_an_invisible_environment_has_a_black_background(gpu, owned):
    for environment in (None, Environment(visible=False)):
        background = EnvironmentTexture(gpu, environment)
        owned(background.texture)
        assert not background.texture.read()[..., :3].any()


def test_a_constant_environment_is_a_map_too():
    assert (environment_map(Environment(radiance=(1, 2, 3), scale=2.0)) == [2, 4, 6]).all()


def test_a_large_map_is_averaged_as_a_whole_one_is():
    pixels = np.random.default_rng(5).lognormal(size=(300, 610, 3)).astype(np.float32)
    made = sky.shrunk_map(Environment(map=pixels, scale=0.7))
    squares = (pixels[:300, :608].astype(np.float64) * 0.7).reshape(75, 4, 152, 4, 3)
    np.testing.assert_array_equal(made, squares.mean(axis=(1, 3)))


def test_a_map_is_uploaded_in_bands(gpu, monkeypatch):
    pixels = np.random.default_rng(6).lognormal(size=(13, 26, 3)).astype(np.float32)
    monkeypatch.setattr(sky, "_BAND_BYTES", 8 * 26 * 4)
    shown = sky.EnvironmentTexture(gpu, Environment(map=pixels, scale=2.0)).texture.read()
    np.testing.assert_array_equal(shown[..., :3], (pixels * np.float64(2.0)).astype(np.float16))
