"""The second paper's figures: a hop's parts add up, and stages stand under the paper's names.

Drawn from pretended images in test_registry: airlight.figures.lpvms_1, airlight.figures.lpvms_2,
airlight.figures.lpvms_5, airlight.figures.lpvms_6, airlight.figures.lpvms_7.
"""

from __future__ import annotations

import numpy as np
import pytest

from airlight.figures import lpvms_3, lpvms_table1
from airlight.figures.panels import Request
from airlight.reference.flatland import basis


def test_what_a_hop_passes_on_and_scatters_is_all_there_was() -> None:
    drawn = lpvms_3.draw(Request((48, 27), quick=True))
    power = drawn.numbers["power"]
    assert power["passed on"] == pytest.approx(1.0)
    assert power["together"] == pytest.approx(1.0)
    assert power["left after extinction"] + power["scattered"] == pytest.approx(1.0)
    # A face is one cell away, edges and corners further.
    assert 0.0 < power["left after extinction"] < np.exp(-lpvms_3.DEPTH)


def test_a_state_as_flatland_s_bands() -> None:
    state = np.zeros((1, 3, 3, 3, 4))
    state[0, 1, 1, 1] = 4.0 * np.pi * np.array([1.0, 0.3, -0.2, 9.0])
    angle = np.linspace(0.0, 6.0, 7)
    got = basis(angle, 2) @ lpvms_3.flat(state)[1, 1]
    assert np.allclose(got, 1.0 + 0.3 * np.cos(angle) - 0.2 * np.sin(angle))


def test_every_row_of_the_paper_has_a_stage_of_ours() -> None:
    assert lpvms_table1.STAGES.keys() == lpvms_table1.PAPER_MS.keys()
    assert sum(row[0] for row in lpvms_table1.PAPER_MS.values()) == pytest.approx(7.93)
