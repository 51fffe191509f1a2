"""The script that fits the table: an entry fitted again is the table's."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import cosines_fit
from airlight.maths.area_light import cosine_table


def test_an_entry_of_the_table() -> None:
    row, column = 20, 0
    alpha, cosine = cosines_fit.row_alpha(row), cosines_fit.view_cosine(column)
    matrix, _, albedos = cosines_fit.fitted(cosine, alpha, None)
    inverse = np.linalg.inv(matrix)
    inverse /= inverse[1, 1]
    entry = cosine_table()[row, column]
    # Two starts of one search end within its tolerance of each other.
    np.testing.assert_allclose(inverse[[0, 0, 2, 2], [0, 2, 0, 2]], entry[:4], atol=5e-3)
    np.testing.assert_allclose(albedos, entry[4:], rtol=1e-5)


@pytest.mark.parametrize("alpha", [0.1, 0.5])
def test_half_vectors_have_the_density_that_the_lobe_says(alpha: float) -> None:
    view = np.array((0.6, 0.0, 0.8))
    at = (np.arange(64) + 0.5) / 64
    u = np.stack([x.ravel() for x in np.meshgrid(at, at)], axis=1)
    light = cosines_fit.half_vectors(view, alpha, u)
    value, density, _ = cosines_fit.ggx_lobe(view, light, alpha)
    albedo = float((value / np.maximum(density, 1e-12)).mean())
    cosines = cosines_fit.cosine_directions(u)
    value, _, _ = cosines_fit.ggx_lobe(view, cosines, alpha)
    # The same integral with directions of another density.
    assert float((value / (cosines[:, 2] / np.pi)).mean()) == pytest.approx(albedo, rel=0.02)
