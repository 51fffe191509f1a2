"""Nothing flickers: a slow turn of map or camera changes the light in proportion."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.maths.latlong import latlong_texel_directions
from airlight.maths.transforms import F64
from airlight.pop.light.illumination import Illumination
from airlight.pop.settings import PopSettings
from airlight.pop.solver import PopSolver
from airlight.scene import Environment, Volume

BALL = Volume((3.0,) * 3, shape="sphere", g=(0.0, 0.7, 0.95))
TOWARDS = latlong_texel_directions(48, 96)
SUN = TOWARDS @ np.array([0.48, 0.64, -0.6]) > 0.99
MAP = (0.3 + 40.0 * SUN[..., None] * np.ones(3)).astype(np.float32)


@pytest.mark.parametrize("what", ["map", "camera"])
def test_half_the_turn_is_half_the_change(gpu: Gpu, what: str) -> None:
    solver = PopSolver(gpu, BALL, PopSettings(ordinates=32, grid=8, solver_steps=16))

    def emission(angle_deg: float) -> F64:
        turn = np.radians(angle_deg if what == "camera" else 0.0)
        eye = 4.0 * np.array([np.sin(turn), 0.3, np.cos(turn)])
        sky = Environment(map=MAP, rotation_deg=angle_deg if what == "map" else 0.0)
        commands = Commands(gpu)
        solver.encode(commands, Illumination((), sky, eye))
        commands.submit()
        return solver.emission.texture.read()[..., :3].astype(np.float64) * solver.scale

    frames = [emission(0.5 * k) for k in range(7)]
    mean = np.mean(frames, axis=(0, 1, 2, 3))
    halves, wholes = (
        np.abs(np.array(frames[k:]) - frames[:-k]).mean(axis=(1, 2, 3)) / mean for k in (1, 2)
    )
    assert np.max(halves, axis=0) == pytest.approx(np.zeros(3), abs=0.05)
    assert np.max(halves) < 0.7 * np.max(wholes)
    # No frame jumps: the largest step is not far from the mean one.
    assert np.all(np.max(halves, axis=0) < 2.0 * np.mean(halves, axis=0) + 1e-3)
