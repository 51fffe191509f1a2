"""The benchmark of rays counts what it sends, and tells it as a table."""

from __future__ import annotations

from typing import Any

from airlight.app.bench import rays
from airlight.app.bench.tables import tables


def test_it_runs_and_is_told(gpu: Any) -> None:
    found = rays.measure("auto", (), lambda stage, fraction: None, quick=True)
    (case,) = found["cases"]
    sent = [kind["rays"] for kind in case["kinds"].values()]
    pixels = rays.QUICK_SIZE[0] * rays.QUICK_SIZE[1]
    assert sent[0] == pixels
    # Most of the room's pixels see something; both other kinds start from the same ones.
    assert 0.9 * pixels < sent[1] == sent[2] <= pixels
    assert case["bytes"] < 100 * case["triangles"]
    (table,) = tables({"rays": found})
    assert {len(row) for row in table.rows} == {len(table.columns)}
