"""How hops converge, and why a residuum is solved instead (Elek2014 Fig. 13)."""

from __future__ import annotations

from typing import Any

from ..app.compare.images import contact_sheet
from .panels import Drawn, Request
from .polar import OURS, TRUTH, polar_plots
from .pop_cube import Angular, by_beams, by_hops, truth

G = 0.7
HOPS = (1, 4, 16, 32, 64, 128)
STEPS = (1, 4, 8, 16, 36)


def draw(request: Request) -> Drawn:
    """The cube of Fig. 12 at g = 0.7 after more and more iterations; red Monte Carlo."""
    # The truth, and the factor that the paper's light is scaled by once it has converged.
    true = truth(G, 20_000 if request.quick else 8_000_000)
    side = max(request.size[1], 240)
    rows: list[Any] = []
    numbers: dict[str, Any] = {"g": G}
    last = HOPS[2] if request.quick else HOPS[-1]
    shown = [n for n in HOPS if n <= last]
    converged = by_hops(G, last, is_paper=True).radiance.mean()
    scale = float(true.radiance.mean() / converged)

    # Hops of two schemes, and steps of the solver of the third.
    for name, values in (("paper", shown), ("split", shown), ("delta-beam", list(STEPS))):
        request.report(name, 0.3)
        cells = []
        told = {}
        for n in values:
            mine = (
                by_beams(G, n) if name == "delta-beam" else by_hops(G, n, is_paper=name == "paper")
            )
            if name == "paper":
                mine = Angular(scale * mine.radiance)
            plot = polar_plots([(TRUTH, true.shown), (OURS, mine.shown)], side)
            error = mine.error(true)
            cells.append((f"{n}: off by {error:.2f}", plot))
            told[str(n)] = mine.scores(true)
        unit = "solver steps" if name == "delta-beam" else "hops"
        rows.append((f"{name}, {unit}", cells))
        numbers[name] = {unit: told}
    numbers["paper"]["scaled_by"] = scale
    image = contact_sheet("Convergence at g = 0.7", rows, cell_width_px=side)
    return Drawn(image, numbers)
