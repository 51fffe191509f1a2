"""Light between the cells of a medium."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.maths.halved_cells import halved_cells, spline_weights
from airlight.pop.light.illumination import Illumination
from airlight.pop.settings import PopSettings
from airlight.pop.solver import PopSolver
from airlight.scene.lights import DirectionalLight
from airlight.scene.volume import Volume

SUN = DirectionalLight((0.3, -0.8, 0.2), (3.0, 2.0, 1.0))
EYE = np.array([3.0, 1.0, 2.0])


def test_light_between_cells_is_that_of_its_twin(gpu: Gpu) -> None:
    """Where the medium reaches; half floats are rounded to 1/2048 at most."""
    density = np.zeros((12, 12, 12), np.float32)
    density[3:6, 2:5, 3:9] = 1.0
    solver = PopSolver(gpu, Volume(4.0, density), PopSettings(ordinates=4, grid=6))
    commands = Commands(gpu)
    solver.encode(commands, Illumination((SUN,), None, EYE))
    commands.submit()
    reach = solver.medium.density.reach.read(np.uint32).reshape(solver.medium.placement.count[::-1])
    assert 0.1 < reach.mean() < 0.9
    light = solver.emission.texture.read()[..., :3]
    expected = halved_cells(light, reach)
    assert expected.max() > 0.01
    got = solver.emission.smooth.texture.read()[..., :3]
    np.testing.assert_allclose(got, expected, rtol=1e-3, atol=1e-5)


@pytest.mark.parametrize("t", [0.25, 0.75])
def test_splines_follow_curves(t: float) -> None:
    """Weights sum to 1 and keep parabolas; what falls off by half is within a hundredth."""
    x, weights = np.arange(-1.0, 3.0), spline_weights(t)
    for power in range(3):
        assert weights @ x**power == pytest.approx(t**power, abs=1e-12)
    assert weights @ 0.5**x == pytest.approx(0.5**t, rel=0.01)
    linear = (1.0 - t) + t * 0.5
    assert abs(weights @ 0.5**x - 0.5**t) < 0.5 * abs(linear - 0.5**t)


def test_nothing_leaves_the_range_of_its_neighbours() -> None:
    rng = np.random.default_rng(2)
    values = np.where(rng.random((5, 4, 6, 1)) < 0.5, 1.0, 0.0)
    made = halved_cells(values, np.ones((5, 4, 6)))
    assert (made.min(), made.max()) == (0.0, 1.0)
    known = rng.random((5, 4, 6)) < 0.4
    assert (
        halved_cells(np.ones((5, 4, 6, 1)), known)[..., 0]
        == known.repeat(2, 0).repeat(2, 1).repeat(2, 2)
    ).all()
