"""What counts as light that leaked."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.figures.clpv_leaks import dark_places, leak_image, leaked, leaked_share


@pytest.fixture
def truth():
    light = np.full((4, 6, 3), 1.0, np.float32)
    light[:, :2] = 0.01  # behind the wall
    light[0, 0] = 0.0  # nothing there
    return light


def test_dark_is_what_has_little_light_but_a_surface(truth):
    dark = dark_places(truth)
    assert dark.sum() == 7
    assert not dark[0, 0]
    assert not dark[:, 2:].any()


def test_light_behind_the_wall_leaked_and_errors_elsewhere_did_not(truth):
    indirect = truth * 1.5
    indirect[2, 1] = 0.31
    leak = leaked(indirect, truth)
    assert leak[2, 1] == pytest.approx(0.3, rel=1e-3)
    assert np.count_nonzero(leak) == 1
    assert leaked_share(indirect, truth) == pytest.approx(0.3 / (16 + 0.07), rel=1e-3)
    assert leaked_share(truth, truth) == 0.0


def test_it_is_drawn_in_red_over_grey(truth):
    indirect = truth.copy()
    indirect[2, 1] = 0.5
    image = leak_image(indirect, truth, 0.0).astype(int)
    red, green, blue = image[2, 1]
    assert red > 100
    assert green == blue == 0
    assert (np.ptp(image[:, 2:], axis=-1) == 0).all()
