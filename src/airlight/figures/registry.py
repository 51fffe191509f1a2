"""Every figure by its name, and how one is drawn and stored."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

from ..errors import SettingsError, nearest
from .panels import Drawn, Request


@dataclass(frozen=True)
class Figure:
    """What a figure shows, which one of the paper it stands beside, and the module that draws it.

    The module has `draw(request) -> Drawn`.
    """

    source: str
    shows: str
    module: str

    def draw(self, request: Request) -> Drawn:
        """Make it. Raises AirlightError."""
        made = importlib.import_module(f"{__package__}.{self.module}")
        return cast(Drawn, made.draw(request))


_PAPER = "Kaplanyan2010"
_POP = "Elek2014"
_SCATTER = "Billeter2012"

FIGURES: dict[str, Figure] = {
    "clpv-1": Figure(f"{_PAPER} Fig. 1", "the atrium, in clear and in hazy air", "clpv_1"),
    "clpv-5": Figure(
        f"{_PAPER} Fig. 5", "flatland: five ways to propagate light beside the truth", "clpv_5"
    ),
    "clpv-6": Figure(
        f"{_PAPER} Fig. 6",
        "one bounce in grey stone beside a path tracer's and imperfect shadow maps'",
        "clpv_6",
    ),
    "clpv-7": Figure(
        f"{_PAPER} Fig. 7", "without occlusion, with it, and with further bounces", "clpv_7"
    ),
    "clpv-9": Figure(f"{_PAPER} Fig. 9", "a polished floor that reflects the lattice", "clpv_9"),
    "clpv-10": Figure(
        f"{_PAPER} Fig. 10", "foliage, and how far its light jumps while the sun moves", "clpv_10"
    ),
    "clpv-11": Figure(
        f"{_PAPER} Fig. 11",
        "light that bleeds through thin boards and a wall; a shadow that no view sees cast",
        "clpv_11",
    ),
    "clpv-12": Figure(
        f"{_PAPER} Fig. 12", "the lattice's spacing, and the number of iterations", "clpv_12"
    ),
    "clpv-table1": Figure(
        f"{_PAPER} Table 1", "what each stage costs, beside the paper's machines", "clpv_table1"
    ),
    "lpvms-1": Figure(
        f"{_SCATTER} Fig. 1", "fog lit many times, shafts alone, and no fog at all", "lpvms_1"
    ),
    "lpvms-2": Figure(
        f"{_SCATTER} Fig. 2", "the lattice on surfaces, in the air, and with the beam", "lpvms_2"
    ),
    "lpvms-3": Figure(
        f"{_SCATTER} Fig. 3", "one hop: what is passed on, lost and scattered", "lpvms_3"
    ),
    "lpvms-5": Figure(f"{_SCATTER} Fig. 5", "six ways to draw a foggy scene", "lpvms_5"),
    "lpvms-6": Figure(
        f"{_SCATTER} Fig. 6",
        "failures: bleeding, light smaller than a cell, one iteration",
        "lpvms_6",
    ),
    "lpvms-7": Figure(
        f"{_SCATTER} Fig. 7", "foggy scenes beside a path tracer's, with scores", "lpvms_7"
    ),
    "lpvms-table1": Figure(
        f"{_SCATTER} Table 1", "what each stage costs, beside the paper's machine", "lpvms_table1"
    ),
    "clpv-debug": Figure("", "the lattice cut open: light, its direction, and walls", "clpv_debug"),
    "clpv-leaks": Figure(
        f"{_PAPER} Fig. 11", "indirect light where a reference has the dark", "leaks"
    ),
    "preview-to-truth": Figure(
        "",
        "stills of more and more samples beside a path tracer's at equal time",
        "preview_to_truth",
    ),
    "pop-1": Figure(f"{_POP} Fig. 1", "smoke under a complex map", "pop_1"),
    "pop-6": Figure(f"{_POP} Fig. 6", "what prefiltering does to a thin medium", "pop_6"),
    "pop-7": Figure(f"{_POP} Fig. 7", "few ordinates, chosen in different ways", "pop_7"),
    "pop-8": Figure(f"{_POP} Fig. 8", "milk: what the isotropic residuum saves", "pop_8"),
    "pop-10": Figure(f"{_POP} Fig. 10", "a lamp in a ball of air beside Monte Carlo", "pop_10"),
    "pop-11": Figure(f"{_POP} Fig. 11", "a plume beside SHDOM and Monte Carlo", "pop_11"),
    "pop-12": Figure(
        f"{_POP} Fig. 12", "directions of light in a cube beside Monte Carlo", "pop_12"
    ),
    "pop-13": Figure(f"{_POP} Fig. 13", "the same after more and more iterations", "pop_13"),
    "pop-14": Figure(f"{_POP} Fig. 14", "more and more ordinates", "pop_14"),
    "pop-15": Figure(f"{_POP} Fig. 15", "clouds with and without forward scattering", "pop_15"),
    "pop-16": Figure(f"{_POP} Fig. 16", "a plume in motion, and how steady its light is", "pop_16"),
    "pop-17": Figure(f"{_POP} Fig. 17", "smoke and surfaces in each other's light", "pop_17"),
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
