"""What the isotropic residuum saves at an unchanged picture (Elek2014 Fig. 8)."""

from __future__ import annotations

from typing import Any

from ..scene.image import Image
from ..scene.scene import Scene
from .panels import Drawn, Request, exposed, exposure_of, sheet
from .pop_scenes import away, drawn, milk, turned

GRID, ORDINATES, FULL, SWITCHED, SHARED = 16, 64, 100, 20, 20
CASES = (("map 1, front", 0.0, (1.5, 2.0, 7.0)), ("map 2, back", 150.0, (-2.0, 1.0, -7.0)))
_SOLVING = ("pop propagation", "pop merge", "pop residuum", "pop deposit", "pop diffuse")


def draw(request: Request) -> Drawn:
    """Milk under two maps: the paper's hops alone, with its residuum, and what replaces both."""
    rows, numbers = [], {}
    for name, angle, position in CASES[: 1 if request.quick else 2]:
        scene = turned(milk(position), angle)
        found = {
            "all hops": _solved(request, scene, FULL, residuum=False),
            "residuum": _solved(request, scene, SWITCHED, residuum=True),
        }  # fmt: skip
        ours = {"split": {"scheme": "split", "iterations": SWITCHED}, "delta-beam": {}}
        for label, settings in ours.items():
            found[label] = _timed(request, scene, {"grid": GRID, **settings})
        cells: list[Any] = []
        told: dict[str, Any] = {}
        full = found["all hops"]
        for label, (image, times) in found.items():
            spent = sum(times.values())
            is_paper = label in ("all hops", "residuum")
            stops = exposure_of(scene, image.radiance)
            cells += exposed(request, [(f"{label}: {spent:.0f} ms", image.radiance)], stops)
            told[label] = {"ms": times, "solving_ms": spent, "hops": image.stats.get("hops")}
            if is_paper:
                told[label]["from_all_hops_l2"] = away(image.radiance, full[0].radiance)
        told["speed_up"] = sum(full[1].values()) / max(sum(found["residuum"][1].values()), 1e-9)
        numbers[name] = told
        rows.append((name, cells))
    numbers["paper"] = {"speed_up": 4.0, "hops": [FULL, SWITCHED, SHARED]}
    return Drawn(sheet(request, "Isotropic residuum, each exposed by itself", rows), numbers)


def _solved(request: Request, scene: Scene, hops: int, *, residuum: bool) -> Any:
    settings = {
        "scheme": "paper", "grid": GRID, "ordinates": ORDINATES, "iterations": hops,
        "residuum": residuum, "residuum_iterations": SHARED,
    }  # fmt: skip
    return _timed(request, scene, settings)


def _timed(request: Request, scene: Scene, settings: dict[str, Any]) -> tuple[Image, Any]:
    """A picture, and the milliseconds of the stages that solve."""
    from ..rendering import Renderer

    quick = {"grid": 6, "ordinates": 4, "iterations": 4} if request.quick else {}
    merged = {**settings, **quick}
    image = drawn(request, scene, settings)
    with Renderer(scene, "pop", request.size, settings=merged, adapter=request.adapter) as made:
        made.frame(read=False)
        made.scene = turned(scene, 1.0)
        passes = made.timed_passes()
    return image, {name: passes[name] for name in _SOLVING if name in passes}
