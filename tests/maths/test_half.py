"""Half floats, slice by slice."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.half import HALF_MAX, half_floats, half_scale


def test_values_are_rounded_and_limited():
    values = np.random.default_rng(0).lognormal(5.0, 5.0, (4, 3, 2)).astype(np.float32)
    made = half_floats(values)
    assert made.dtype == np.float16
    assert made.max() == HALF_MAX
    np.testing.assert_array_equal(made, np.minimum(values, HALF_MAX).astype(np.float16))


def test_they_are_scaled_in_double_precision():
    values = np.random.default_rng(1).random((50, 3)).astype(np.float32)
    wanted = (values.astype(np.float64) * 0.1).astype(np.float16)
    np.testing.assert_array_equal(half_floats(values, 0.1), wanted)


@pytest.mark.parametrize("largest", [0.0, 1e-9, 1.0, 999.0, 3e7])
def test_the_scale_leaves_room_and_changes_no_bits(largest):
    scale = half_scale(largest)
    assert np.log2(scale) == round(np.log2(scale))
    assert largest * scale <= 1000.0 < HALF_MAX
    assert largest == 0.0 or largest * scale > 500.0
