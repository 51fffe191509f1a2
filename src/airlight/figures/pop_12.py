"""Where light goes in a cube beside Monte Carlo, for three phase functions (Elek2014 Fig. 12)."""

from __future__ import annotations

from typing import Any

from ..app.compare.images import contact_sheet
from .panels import Drawn, Request
from .polar import OURS, TRUTH, polar_plots
from .pop_cube import SIGMA_S, Angular, by_beams, by_hops, truth

ANISOTROPIES = (0.0, 0.7, 0.96)
_HOPS = 24


def draw(request: Request) -> Drawn:
    """Scattered light in the middle slice, light from below; red Monte Carlo, blue ours."""
    # Directions in the cells of one slice, by three schemes.
    photons = 20_000 if request.quick else 8_000_000
    rows: dict[str, list[Any]] = {"delta-beam": [], "split": [], "paper, scaled": []}
    numbers: dict[str, Any] = {"cube": {"sigma_s": SIGMA_S, "cells": 16}, "photons": photons}
    side = max(request.size[0] * 3 // 4, 240)
    for index, g in enumerate(ANISOTROPIES):
        request.report(f"g = {g}", index / len(ANISOTROPIES))

        # The paper's light is far too bright; scaled to the truth's, its shape shows.
        true = truth(g, photons)
        paper = by_hops(g, _HOPS, is_paper=True)
        scale = float(true.radiance.mean() / paper.radiance.mean())
        found = {
            "delta-beam": by_beams(g),
            "split": by_hops(g, _HOPS),
            "paper, scaled": Angular(scale * paper.radiance),
        }
        told: dict[str, Any] = {"paper_is_too_bright_by": 1.0 / scale}

        # Plots of the truth in red, of ours in blue.
        for name, mine in found.items():
            plot = polar_plots([(TRUTH, true.shown), (OURS, mine.shown)], side)
            error = mine.error(true)
            rows[name].append((f"g = {g}: off by {error:.2f}", plot))
            told[name] = mine.scores(true)
        numbers[f"g {g}"] = told
    image = contact_sheet(
        "Directions of scattered light in a cube; Monte Carlo red, ours blue",
        list(rows.items()),
        cell_width_px=side,
    )
    return Drawn(image, numbers)
