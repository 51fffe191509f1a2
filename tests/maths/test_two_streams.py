"""Two streams in layers: what they add up to, and what two layers are together."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.two_streams import columns, layer


def test_white_layers_keep_all_light() -> None:
    depth = np.array([0.0, 1e-9, 0.1, 2.0, 50.0])
    reflected, transmitted = layer(depth, 1.0)
    np.testing.assert_allclose(reflected + transmitted, 1.0, rtol=1e-12)
    # Half of what collides turns round.
    np.testing.assert_allclose(transmitted, 1.0 / (1.0 + 0.5 * depth), rtol=1e-9)


def test_black_layers_transmit_what_does_not_collide() -> None:
    depth = np.array([0.2, 3.0])
    reflected, transmitted = layer(depth, 0.0)
    np.testing.assert_allclose(reflected, 0.0)
    np.testing.assert_allclose(transmitted, np.exp(-depth), rtol=1e-12)


@pytest.mark.parametrize("albedo", [0.3, 0.8, 0.999999, 1.0])
@pytest.mark.parametrize("depths", [(0.3, 0.5), (2.0, 6.0)])
def test_two_layers_are_one(depths: tuple[float, float], albedo: float) -> None:
    """However a medium is cut into cells, it reflects and transmits the same."""
    (r1, t1), (r2, t2) = (layer(x, albedo) for x in depths)
    between = 1.0 / (1.0 - r1 * r2)
    reflected, transmitted = layer(sum(depths), albedo)
    assert transmitted == pytest.approx(t1 * t2 * between, rel=1e-9)
    assert reflected == pytest.approx(r1 + t1 * t1 * r2 * between, rel=1e-9)


@pytest.mark.parametrize("albedo", [0.0, 0.9])
def test_columns_let_more_through_than_their_mean_depth(albedo: float) -> None:
    """Half of a face in the open passes half of the light, however dense the rest is."""
    reflected, transmitted = columns([0.0, 400.0], albedo)
    assert reflected == pytest.approx(0.5 * layer(400.0, albedo)[0], rel=1e-12)
    assert transmitted == pytest.approx(0.5, abs=1e-3)
    assert transmitted > 5.0 * layer(200.0, albedo)[1]
    np.testing.assert_allclose(columns([3.0] * 4, albedo), layer(3.0, albedo), rtol=1e-12)
