"""`./run gpu`: test this machine's graphics device and write one Markdown report.

The device's name, driver, features and limits; the device's tests on the code paths of GPUs and of
CPUs; how far the images of both are from one another; and what frames of every technique cost, each
stage beside the bytes that its passes bind and the invocations that they start. Exit code 1 where a
test fails or images differ more than tests/kept/paths.toml allows; the report is written even so.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from airlight import __version__
from airlight.app.bench.frames import Case, measure
from airlight.app.outputs import check_writable
from airlight.errors import AirlightError
from airlight.gpu.device import open_gpu
from airlight.scene.builtin import builtin_scene
from scripts import script

from . import pages, tests_on_device

SIZE, QUICK_SIZE = (1280, 720), (64, 36)
CASES = (
    ("atrium", "builtin:atrium", "lpv"),
    ("atrium in fog", "builtin:atrium-fog", "lpv-scatter"),
    ("smoke", "builtin:smoke", "pop"),
)
QUICK_PATHS = ("cornell lpv",)
SMALL: Mapping[str, Any] = {
    "resolution": 12,
    "shadow_resolution": 64,
    "lamp_resolution": 32,
    "sky_lights": 8,
    "surfels": 4000,
}
Say = Callable[[str], None]


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the report and return the exit code."""
    options = _parser().parse_args(arguments)
    try:
        check_writable(options.output)
        text, is_good = report(options.adapter, is_quick=options.quick, say=_to_stderr)
    except AirlightError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    partial = options.output.with_name(options.output.name + ".part")
    partial.write_text(text, encoding="utf-8")
    partial.replace(options.output)
    print(options.output)
    return 0 if is_good else 1


def report(adapter: str, *, is_quick: bool, say: Say) -> tuple[str, bool]:
    """The report, and whether all was as it should be. Raises AirlightError."""
    gpu = open_gpu(adapter)
    parts = [f"# airlight {__version__} on {gpu.info.name}", pages.device_page(gpu)]
    chosen = tests_on_device.QUICK if is_quick else tests_on_device.FOLDERS
    outcomes = []
    for paths in ("gpu", "cpu"):
        say(f"tests on the paths of {paths} ...")
        outcomes.append(tests_on_device.run(paths, adapter, chosen))
    parts.append(pages.tests_page(outcomes))
    say("both paths ...")
    off, ceilings = both_paths(QUICK_PATHS if is_quick else None)
    parts.append(pages.paths_page(off, ceilings))
    cases = []
    for case in frame_cases(is_quick=is_quick):
        say(f"frames of {case.name} ...")
        scene = builtin_scene(case.scene.removeprefix("builtin:"))
        cases.append({"name": case.name, **measure(scene, case, 1 if is_quick else 15, adapter)})
    parts.append(pages.frames_page(cases))
    is_near = all(off[c][layer] <= ceilings[c][layer] for c in off for layer in off[c])
    return "\n\n".join(parts) + "\n", is_near and all(found.is_good for found in outcomes)


def frame_cases(*, is_quick: bool) -> list[Case]:
    """What is drawn; tiny, and the first alone, where `is_quick`."""
    if is_quick:
        return [Case(*CASES[0][:2], QUICK_SIZE, SMALL, CASES[0][2])]
    return [Case(name, scene, SIZE, {}, technique) for name, scene, technique in CASES]


def both_paths(
    chosen: Sequence[str] | None,
) -> tuple[dict[str, dict[str, float]], dict[str, dict[str, Any]]]:
    """How far the images of both paths are apart, and the most that is allowed, by case."""
    module = script(Path(__file__).parents[1] / "kept" / "measure_paths.py")
    ceilings = module.read_cases()
    before = os.environ.get(module.SWITCH)
    try:
        off = {
            case: module.distances(*module.both(case, os.environ.__setitem__))
            for case in chosen or ceilings
        }
    finally:
        os.environ.pop(module.SWITCH, None)
        if before is not None:
            os.environ[module.SWITCH] = before
    return off, ceilings


def _to_stderr(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="./run gpu", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("gpu-report.md"))
    parser.add_argument("--adapter", default="auto", help="auto, cpu, gpu or a part of its name")
    parser.add_argument("--quick", action="store_true", help="tiny sizes: does it work?")
    return parser


if __name__ == "__main__":
    sys.exit(main())
