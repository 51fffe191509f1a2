"""Volumes of many colours: each channel of an image is that of a grey volume."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.rendering import Renderer, render
from airlight.scene import Camera, DirectionalLight, Environment, PointLight, Scene, Volume
from airlight.scene.builtin.noise import fractal_noise

BOX = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
MAPS = {"shadow_resolution": 256, "lamp_resolution": 64, "sky_lights": 16, "sky_resolution": 32}
SETTINGS = {
    "pop": {**MAPS, "ordinates": 16, "grid": 10},
    "lpv-scatter": {**MAPS, "resolution": 10, "map_resolution": 64},
    "single": MAPS,
}
# Steps and noise are the same. Of pop the diffusion's bound is that of all channels; of lpv-scatter
# the length of its corrections is, and its iterations leave 2 % where channels differ so much.
OFF = {"pop": 0.01, "lpv-scatter": 0.035, "single": 0.003}


def lit(volume: Volume) -> Scene:
    lights = (
        DirectionalLight((-0.4, -1.0, -0.5), (3.0, 3.0, 3.0)),
        PointLight((1.5, 0.5, 0.5), (2.0, 2.0, 2.0)),
    )
    camera = Camera((0.4, 0.3, 5.0), (0.0, 0.0, 0.0), fov_y_deg=35.0)
    sky = Environment((0.3, 0.3, 0.3))
    return Scene(volumes=(volume,), camera=camera, lights=lights, environment=sky)


def lumps(seed: int) -> np.ndarray:
    noise = fractal_noise((20,) * 3, (3, 3, 3), np.random.default_rng(seed), octaves=2)
    return (noise - noise.min()) / np.ptp(noise)


@pytest.mark.parametrize(
    "technique", ["pop", pytest.param("lpv-scatter", marks=pytest.mark.slow), "single"]
)
def test_a_channel_is_a_grey_volumes(technique):
    """Extinction by voxel and channel: red light sees the red extinction alone."""
    sigma_t = np.stack([lumps(k) for k in range(3)], axis=-1).astype(np.float32)
    colourful = Volume(3.0, sigma_t, bounds=BOX, albedo=(0.95, 0.8, 0.9), g=(0.3, 0.3, 0.3))
    assert len(colourful.parts) == 3
    options = {"size": (32, 24), "samples": 1, "settings": SETTINGS[technique]}
    image = render(lit(colourful), technique, **options).radiance[..., 1]
    own = np.ascontiguousarray(sigma_t[..., 1])
    grey = Volume(3.0, own, bounds=BOX, albedo=(0.8,) * 3, g=(0.3, 0.3, 0.3))
    wanted = render(lit(grey), technique, **options).radiance[..., 1]
    off = np.linalg.norm(image - wanted) / np.linalg.norm(wanted)
    assert off < OFF[technique], off


def test_colours_may_change_in_number():
    """One colour, then no order of colours at all: as a new renderer draws it."""
    density = lumps(5).astype(np.float32)
    dyed = np.stack([lumps(k) for k in (6, 7, 8)], axis=-1).astype(np.float32)
    volumes = [
        Volume(3.0, density, bounds=BOX, albedo_grid=colours)
        for colours in (0.7 * np.ones((20, 20, 20, 3), np.float32), dyed)
    ]
    assert [len(v.parts) for v in volumes] == [1, 6]
    settings = {"settings": SETTINGS["pop"], "size": (16, 12)}
    with Renderer(lit(volumes[0]), "pop", **settings) as renderer:
        renderer.frame()
        changed = renderer.frame(volumes=volumes[1:])
    with Renderer(lit(volumes[1]), "pop", **settings) as renderer:
        np.testing.assert_array_equal(changed.radiance, renderer.frame().radiance)
