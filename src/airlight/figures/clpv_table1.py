"""What each stage costs, under the names of Kaplanyan2010 Table 1 and beside its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..app.bench.frames import (
    PAPER_LATTICE,
    Case,
    measure,
    median_passes,
    under_the_papers_names,
)
from ..app.bench.tables import milliseconds
from ..maths.arrays import U8
from ..scene.builtin import atrium, cornell
from ..scene.scene import Scene
from .clpv_7 import MODES
from .lpvms_table1 import STEP_M, shifted
from .panels import QUICK, Drawn, Request, known, renderer
from .table import table_image

PAPER_MS: dict[str, dict[str, tuple[float, ...]]] = {
    "RSM rendering": {"GTX285": (0.16,), "Xbox 360": (0.5,), "PS3": (0.8,)},
    "VPL Injection": {"GTX285": (0.05,), "Xbox 360": (0.2,), "PS3": (0.4,)},
    "GV Injection": {"GTX285": (0.02,), "Xbox 360": (0.15,), "PS3": (0.15,)},
    "Propagation": {
        "GTX285": (0.8, 1.1, 1.4),
        "Xbox 360": (0.8, 1.1, 1.5),
        "PS3": (0.7, 1.1, 1.5),
    },
    "LPV Lookup": {"GTX285": (2.4,), "Xbox 360": (2.0,), "PS3": (1.5,)},
    "Total": {"GTX285": (3.4, 3.7, 4.0), "Xbox 360": (3.5, 3.8, 4.2), "PS3": (3.4, 3.8, 4.2)},
}
"""Kaplanyan2010 Table 1, ms; three numbers: no occlusion, fuzzy occlusion, multiple bounces."""
STAGES: dict[str, tuple[str, ...]] = {
    "RSM rendering": ("reflective shadow maps",),
    "VPL Injection": ("inject",),
    "GV Injection": ("blockers while all moves",),
    "Propagation": ("propagate", "pack"),
    "LPV Lookup": ("lighting",),
}
"""Our stages under the paper's names. Its lookup pass adds indirect light to an image; ours
computes all of a pixel's light, direct light and its shadows too."""
KEPT = "GV Injection here: all meshes moving. Blockers of static meshes are cached and cost none."


def draw(request: Request) -> Drawn:
    """The atrium with one lattice of 32 cells along its longest side, 8 iterations, a 256^2 map."""
    # One lattice of the paper's size, timed in a few frames.
    scene, frames = (cornell(), 1) if request.quick else (atrium(), 9)
    settings = {**PAPER_LATTICE, **(known("lpv", QUICK) if request.quick else {})}
    found: dict[str, Any] = {}

    # Each mode alone; where surfaces block, blockers are timed while everything moves.
    for label, mode in MODES.items():
        request.report(label, len(found) / len(MODES))
        case = Case(label, scene.name, request.size, {**settings, **mode})
        found[label] = measure(scene, case, frames, request.adapter)
        if mode["occlusion"]:
            moving = passes_while_moving(request, scene, {**settings, **mode}, min(frames, 3))
            found[label]["passes_while_all_moves"] = moving
            found[label]["passes"]["blockers while all moves"] = moving.get("blockers", 0.0)

    # Our stages under the paper's names.
    ours = stages_of([found[label]["passes"] for label in MODES])
    first = next(iter(found.values()))
    device, cells = first["device"], first["lattice"]
    numbers = {
        "stages_ms": {"ours": ours, "paper": PAPER_MS},
        "device": device,
        "lattice": cells,
        "triangles": scene.triangle_count,
        "size": list(request.size),
        "modes": found,
    }
    return Drawn(_table(f"{size_of(cells)}, {device}", ours), numbers)


def passes_while_moving(
    request: Request, scene: Scene, settings: Mapping[str, Any], frames: int
) -> dict[str, float]:
    """Milliseconds per stage, all meshes moving: blockers of static ones are cached, and cost none.

    Raises SettingsError, DeviceError.
    """
    # The first frame compiles; each one after it has moved meshes.
    with renderer(request, scene, settings) as made:
        made.frame(read=False)
        told = []
        for step in range(1, frames + 1):
            made.meshes.move(shifted(scene.meshes, STEP_M * step))
            told.append(made.timed_passes())
    return median_passes(told)


def stages_of(passes: Sequence[Mapping[str, float]]) -> dict[str, tuple[float, ...]]:
    """Per stage of the paper the milliseconds of each mode's passes; their sum as Total."""
    modes = [under_the_papers_names(mode, STAGES) for mode in passes]
    modes = [{**mode, "Total": sum(mode.values())} for mode in modes]
    return {name: tuple(mode[name] for mode in modes) for name in modes[0]}


def size_of(cells: Sequence[int]) -> str:
    """A lattice's size: cubes of cells that fit a scene are seldom as many along every side."""
    return " x ".join(str(count) for count in cells)


def _table(device: str, ours: Mapping[str, tuple[float, ...]]) -> U8:
    """The table as an image."""
    # One column of ours beside the paper's machines.
    machines = ("GTX285", "Xbox 360", "PS3")
    lines: list[tuple[str, ...]] = [
        ("Stage, ms", f"here: {device}"[:38], *(f"{m}, 32^3" for m in machines))
    ]
    for name, times in ours.items():
        theirs = [_times(PAPER_MS[name][machine]) for machine in machines]
        own = times if name in ("Propagation", "Total") else times[-1:]
        lines.append((name, _times(own), *theirs))
    lines.append((KEPT,))
    return table_image(lines, (1, 2, 1, 1, 1))


def _times(values: Sequence[float]) -> str:
    return " / ".join(milliseconds(value) for value in values)
