"""`airlight bench`: how fast this machine is, and how cost grows."""

from __future__ import annotations

import dataclasses
import os
import platform
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ... import __version__
from ..options import (
    adapter_option,
    output_option,
    quiet_option,
    settings_option,
)
from ..outputs import check_writable, write_json
from ..progress import progress
from ..scene_argument import load_scene, reads

if TYPE_CHECKING:
    from ...scene.scene import Scene
    from ..progress import Report
    from .frames import Case

PARTS = ("frames", "propagation", "first-image", "growth", "pop", "rays")
ROOM_SIZE, ATRIUM_SIZE, QUICK_SIZE = (640, 360), (1280, 720), (96, 54)
QUICK_SETTINGS = {"resolution": 12, "iterations": 2, "map_resolution": 32}


@dataclasses.dataclass(frozen=True)
class Plan:
    """How much is measured."""

    frames: int = 15
    kernel_runs: int = 25
    kernel_sides: tuple[int, ...] = (32, 64)
    growth_frames: int = 5
    growth_tables: int | None = None  # None for all
    growth_size: tuple[int, int] = ROOM_SIZE
    is_long: bool = False


QUICK = Plan(
    frames=2,
    kernel_runs=2,
    kernel_sides=(8,),
    growth_frames=1,
    growth_tables=1,
    growth_size=QUICK_SIZE,
)


@click.command("bench")
@output_option("FILE.json", "Keep all numbers.", is_required=False)
@click.option(
    "--scene",
    "scenes",
    multiple=True,
    metavar="SCENE",
    help="Draw it at 640x360 instead of builtin:room; may be repeated.",
)
@click.option(
    "--only", "parts", multiple=True, type=click.Choice(PARTS), help="A part of it; repeatable."
)
@click.option(
    "--long", "is_long", is_flag=True, help="Growth up to five million triangles; minutes more."
)
@click.option("--quick", is_flag=True, help="Tiny sizes and few runs: does it work?")
@click.option("--markdown", "as_markdown", is_flag=True, help="Tables for docs/performance.md.")
@settings_option()
@adapter_option()
@quiet_option()
def command(output: Path | None, **options: Any) -> None:
    """Measure frames, propagation beside C, the first image, memory, growth and rays.

    \b
    airlight bench -o bench.json
    airlight bench --scene living_room.obj --only frames

    In steady state, with the work finished on the device. The light moves every frame; then the
    camera, too.
    """
    reads(*options["scenes"])
    # Minutes of measuring are not to end in a file that cannot be written.
    if output is not None:
        check_writable(output)
    with progress(quiet=options["quiet"]) as report:
        results = measured(report=report, **{k: options[k] for k in _MEASURED})
    if output is not None:
        write_json(results, output)
    _say(results, options["as_markdown"])


_MEASURED = ("scenes", "parts", "quick", "settings", "adapter", "is_long")


def measured(
    *,
    scenes: Sequence[str],
    parts: Sequence[str],
    quick: bool,
    settings: dict[str, str],
    adapter: str,
    report: Report = lambda stage, fraction: None,
    is_long: bool = False,
) -> dict[str, Any]:
    """All numbers, as `-o` keeps them; `parts` of PARTS, all where empty. Raises AirlightError."""
    wanted, plan = parts or PARTS, QUICK if quick else Plan(is_long=is_long)
    results: dict[str, Any] = {"machine": machine(adapter), "is_quick": quick}
    cases = chosen_cases(scenes, settings, quick)
    loaded: dict[str, Scene] = {}
    # The propagation kernel alone, then from the command to the first image.
    if "propagation" in wanted:
        report("propagation", 0.0)
        results["propagation"] = _propagation(plan, adapter)
    if "first-image" in wanted:
        results["first_image"] = _first_images(cases, adapter, report)
    # Whole frames by stage, and how they grow with one setting at a time.
    if "frames" in wanted:
        results["frames"] = _frames(cases, plan, adapter, loaded, report)
    if "growth" in wanted:
        results["growth"] = _growth(plan, settings, adapter, loaded, report)
    # Parts with scenes of their own.
    if "pop" in wanted:
        from .pop import measure

        results["pop"] = measure(adapter, report, quick=quick)
    if "rays" in wanted:
        from . import rays

        results["rays"] = rays.measure(adapter, scenes, report, quick=quick)
    return results


def machine(adapter: str) -> dict[str, Any]:
    """What was measured on. Raises DeviceError where there is no adapter."""
    from ...gpu.device import open_gpu

    gpu = open_gpu(adapter)
    info = gpu.info
    return {
        "airlight": __version__,
        "device": info.name,
        "adapter_type": info.adapter_type,
        "paths": gpu.paths.name,
        "backend": info.backend,
        "driver": info.driver,
        "cpu_cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }


def chosen_cases(scenes: Sequence[str], settings: dict[str, str], quick: bool) -> list[Case]:
    """The frames to draw: `scenes`, or the room and the atrium, also with cascades and in fog.

    The fog has its technique's own settings and `settings`; without it where it lacks one of them.
    """
    from ...techniques import technique_settings
    from .frames import PAPER_LATTICE, Case

    base = {**PAPER_LATTICE, **(QUICK_SETTINGS if quick else {}), **settings}
    # Scenes that were named are drawn as named; without any, the reference cases.
    cases = [Case(Path(s).stem if ":" not in s else s, s, ROOM_SIZE, base) for s in scenes]
    if not scenes:
        cases = [
            Case("room", "builtin:room", ROOM_SIZE, base),
            Case("atrium", "builtin:atrium", ATRIUM_SIZE, base),
            Case("atrium, 3 cascades", "builtin:atrium", ATRIUM_SIZE, {**base, "cascades": 3}),
        ]
        if set(settings) <= set(technique_settings("lpv-scatter").__dataclass_fields__):
            fog = "builtin:atrium-fog"
            cases.append(Case("atrium in fog", fog, ATRIUM_SIZE, settings, "lpv-scatter"))
    # A quick run shows that it works, so one small case will do.
    if quick:
        cases = [dataclasses.replace(case, size=QUICK_SIZE) for case in cases[:1]]
    return cases


def _propagation(plan: Plan, adapter: str) -> dict[str, Any]:
    from ...gpu.device import open_gpu
    from .kernel import measure

    return measure(open_gpu(adapter), plan.kernel_runs, plan.kernel_sides)


def _first_images(cases: Sequence[Case], adapter: str, report: Report) -> list[dict[str, Any]]:
    from .child import first_image

    found = []
    # Each in a process of its own, with imports, compiling and writing.
    for index, case in enumerate(cases):
        report(f"first image of {case.name}", index / len(cases))
        texts = [f"{key}={value}" for key, value in case.settings.items()]
        told = first_image(case.scene, case.size, case.technique, texts, adapter)
        found.append({"name": case.name, "scene": case.scene, **told})
    return found


def _frames(
    cases: Sequence[Case], plan: Plan, adapter: str, loaded: dict[str, Scene], report: Report
) -> list[dict[str, Any]]:
    from .frames import measure

    found = []
    for index, case in enumerate(cases):
        report(f"frames of {case.name}", index / len(cases))
        scene = _loaded(case.scene, loaded)
        found.append({"name": case.name, **measure(scene, case, plan.frames, adapter)})
    return found


def _growth(
    plan: Plan, settings: dict[str, str], adapter: str, loaded: dict[str, Scene], report: Report
) -> list[dict[str, Any]]:
    from ...lpv.settings import LpvSettings
    from .frames import PAPER_LATTICE
    from .growth import axes, table

    # Those settings alone that the lattice knows, as many as the plan has time for.
    known = [axis for axis in axes(is_long=plan.is_long) if axis.is_known(LpvSettings)][
        : plan.growth_tables
    ]
    # The paper's lattice, where the settings say no other.
    base = {**PAPER_LATTICE, **(QUICK_SETTINGS if plan is QUICK else {}), **settings}
    found = []
    for index, axis in enumerate(known):
        report(f"growth with {axis.name}", index / len(known))
        scene = _loaded(axis.scene, loaded)
        found.append(table(axis, scene, plan.growth_size, plan.growth_frames, adapter, base))
    return found


def _loaded(name: str, loaded: dict[str, Scene]) -> Scene:
    if name not in loaded:
        loaded[name] = load_scene(name)
    return loaded[name]


def _say(results: dict[str, Any], as_markdown: bool) -> None:
    from .tables import markdown, show

    if as_markdown:
        click.echo(markdown(results), nl=False)
        return
    from rich.console import Console

    console = Console()
    show(results, console if console.is_terminal else Console(width=160))
