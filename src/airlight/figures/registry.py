"""Every figure by its name, and how one is drawn and stored."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from ..errors import SettingsError, nearest
from .panels import Drawn, Request

_PAPERS = {"clpv": "Kaplanyan2010", "lpvms": "Billeter2012", "pop": "Elek2014"}


@dataclass(frozen=True)
class Figure:
    """What a figure shows, and which one of the paper it stands beside: "Fig. 1", "" for none.

    The paper follows from the name, as does the module, which has `draw(request) -> Drawn`.
    """

    name: str
    beside: str
    shows: str

    @property
    def source(self) -> str:
        """The paper and its figure; "" for none."""
        return f"{_PAPERS[self.name.partition('-')[0]]} {self.beside}" if self.beside else ""

    def draw(self, request: Request) -> Drawn:
        """Make it. Raises AirlightError."""
        made = importlib.import_module(f"{__package__}.{self.name.replace('-', '_')}")
        return cast(Drawn, made.draw(request))


FIGURES: dict[str, Figure] = {
    figure.name: figure
    for figure in (
        Figure("clpv-1", "Fig. 1", "the atrium, in clear and in hazy air"),
        Figure("clpv-5", "Fig. 5", "flatland: five ways to propagate light beside the truth"),
        Figure(
            "clpv-6",
            "Fig. 6",
            "one bounce in grey stone beside a path tracer's and imperfect shadow maps'",
        ),
        Figure("clpv-7", "Fig. 7", "without occlusion, with it, and with further bounces"),
        Figure("clpv-9", "Fig. 9", "a polished floor that reflects the lattice"),
        Figure("clpv-10", "Fig. 10", "foliage, and how far its light jumps while the sun moves"),
        Figure(
            "clpv-11",
            "Fig. 11",
            "light that bleeds through thin boards and a wall; a shadow that no view sees cast",
        ),
        Figure("clpv-12", "Fig. 12", "the lattice's spacing, and the number of iterations"),
        Figure("clpv-table1", "Table 1", "what each stage costs, beside the paper's machines"),
        Figure("lpvms-1", "Fig. 1", "fog lit many times, shafts alone, and no fog at all"),
        Figure("lpvms-2", "Fig. 2", "the lattice on surfaces, in the air, and with the beam"),
        Figure("lpvms-3", "Fig. 3", "one hop: what is passed on, lost and scattered"),
        Figure("lpvms-5", "Fig. 5", "six ways to draw a foggy scene"),
        Figure("lpvms-6", "Fig. 6", "failures: bleeding, light smaller than a cell, one iteration"),
        Figure("lpvms-7", "Fig. 7", "foggy scenes beside a path tracer's, with scores"),
        Figure("lpvms-table1", "Table 1", "what each stage costs, beside the paper's machine"),
        Figure("clpv-debug", "", "the lattice cut open: light, its direction, and walls"),
        Figure("clpv-leaks", "Fig. 11", "indirect light where a reference has the dark"),
        Figure(
            "preview-to-truth",
            "",
            "stills of more and more samples beside a path tracer's at equal time",
        ),
        Figure("pop-1", "Fig. 1", "smoke under a complex map"),
        Figure("pop-6", "Fig. 6", "what prefiltering does to a thin medium"),
        Figure("pop-7", "Fig. 7", "few ordinates, chosen in different ways"),
        Figure("pop-8", "Fig. 8", "milk: what the isotropic residuum saves"),
        Figure("pop-10", "Fig. 10", "a lamp in a ball of air beside Monte Carlo"),
        Figure("pop-11", "Fig. 11", "a plume beside SHDOM and Monte Carlo"),
        Figure("pop-12", "Fig. 12", "directions of light in a cube beside Monte Carlo"),
        Figure("pop-13", "Fig. 13", "the same after more and more iterations"),
        Figure("pop-14", "Fig. 14", "more and more ordinates"),
        Figure("pop-15", "Fig. 15", "clouds with and without forward scattering"),
        Figure("pop-16", "Fig. 16", "a plume in motion, and how steady its light is"),
        Figure("pop-17", "Fig. 17", "smoke and surfaces in each other's light"),
    )
}
"""Figure by name. Diagrams have none, as Elek2014 Fig. 9, the flow of its method, which
docs/architecture.md has for ours."""


def figure(name: str) -> Figure:
    """The figure called `name`. Raises SettingsError naming the nearest."""
    if name not in FIGURES:
        raise SettingsError(f"there is no figure '{name}'", remedy=nearest(name, FIGURES))
    return FIGURES[name]


def keep(name: str, drawn: Drawn, about: dict[str, Any], folder: Path) -> Path:
    """Write NAME.png and NAME.json into `folder`, each whole or not at all; returns the image.

    Raises OutputError.
    """
    from ..app.compare.images import png_bytes
    from ..app.outputs import write_json
    from ..scene.io.writing import whole_file

    # The image, then its numbers, each whole.
    path = folder / f"{name}.png"
    with whole_file(path) as part:
        part.write_bytes(png_bytes(drawn.image))
    known = FIGURES[name]
    told = {"figure": name, "shows": known.shows, "beside": known.source, "picture": path.name}
    write_json({**told, **about, "numbers": drawn.numbers}, folder / f"{name}.json")
    return path
