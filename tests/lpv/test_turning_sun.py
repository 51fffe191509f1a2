"""Indirect light of a sun that turns a little from frame to frame: it changes as smoothly."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import airlight
from airlight.rendering import Renderer
from airlight.surface import light_maps

TURN_DEG = 0.25
SETTINGS = {"sky_lights": 0, "ambient_occlusion": False}


def turned(light, degrees):
    """The sun, turned about the vertical."""
    x, y, z = light.direction
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return dataclasses.replace(light, direction=(c * x + s * z, y, c * z - s * x))


def energies(frames=20):
    """(frames,): the atrium's indirect light, as rendered, frame by frame; its mean is 1."""
    scene = airlight.load("builtin:atrium")
    with Renderer(scene, "lpv", (64, 36), settings=SETTINGS) as renderer:
        found = []
        for k in range(frames):
            lights = (turned(scene.lights[0], TURN_DEG * k), *scene.lights[1:])
            image = renderer.frame(samples=1, lights=lights)
            found.append(float(image.layers["indirect"].sum()))
    return np.array(found) / np.mean(found)


def jumps(energy):
    """How far each frame is from the middle between the two beside it, root mean square."""
    return float(np.sqrt(np.mean((energy[1:-1] - 0.5 * (energy[2:] + energy[:-2])) ** 2)))


def test_indirect_light_does_not_jump_while_the_sun_turns(gpu):
    # Measured .00097 and .0028. In 20 frames .00095 and .0028; with a texel for each light, along
    # the walls, .0027 and .0083.
    energy = energies(12)
    assert jumps(energy) < 0.0012
    assert np.abs(np.diff(energy)).max() < 0.004


@pytest.mark.slow
def test_blocks_and_their_turn_each_make_it_steadier(gpu, monkeypatch):
    best = jumps(energies())
    monkeypatch.setattr(light_maps, "TURN_DEG", 0.0)
    assert best < 0.9 * jumps(energies())
