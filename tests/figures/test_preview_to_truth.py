"""When errors that fall come down to what is asked."""

from __future__ import annotations

import pytest

from airlight.figures.preview_to_truth import reached


def test_a_power_law_is_met_where_it_passes():
    """Error 1/sqrt(t): .1 after 100 s, between 64 and 256."""
    seconds = [4.0, 16.0, 64.0, 256.0]
    errors = [t**-0.5 for t in seconds]
    assert reached(seconds, errors, 0.1) == pytest.approx(100.0)
    assert reached(seconds, errors, 0.6) == 4.0
    assert reached(seconds, errors, 0.05) is None
