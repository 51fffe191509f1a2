"""`./run soak`: frames with everything moving, renderers made and closed, resizes; is memory flat?

Exit code 1, and what grew, where the process or the device holds over 1 % more than after the
first tenth of a phase, or more of wgpu's objects.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from time import monotonic

from airlight.techniques import TECHNIQUES

from .levels import Course
from .phases import Plan, frames, renderers, resizes


def main(arguments: Sequence[str] | None = None) -> int:
    """Soak and return the exit code: 1 where something grew."""
    options = _parser().parse_args(arguments)
    width, _, height = options.size.partition("x")
    plan = Plan(
        options.frames,
        options.renderers,
        options.resizes,
        (int(width), int(height)),
        tuple(options.technique or TECHNIQUES),
        int(options.slack * 2**20),
    )
    return soak(plan)


def soak(plan: Plan) -> int:
    """Run all phases that the plan has anything for, and print a line for each."""
    phases: list[Callable[[], Course]] = [
        *(lambda name=name: frames(name, plan) for name in plan.techniques if plan.frames),
        *([lambda: renderers(plan)] if plan.renderers else []),
        *([lambda: resizes(plan)] if plan.resizes else []),
    ]
    code = 0
    for phase in phases:
        began = monotonic()
        course = phase()
        print(f"{course.line()}, {monotonic() - began:.0f} s", flush=True)
        for what in course.grown():
            code = 1
            print(f"  grew: {what}", flush=True)
    print("something grew" if code else "all is flat")
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="./run soak", description=__doc__)
    parser.add_argument("--frames", type=int, default=10_000, help="of each technique")
    parser.add_argument("--renderers", type=int, default=100, help="to make and close")
    parser.add_argument("--resizes", type=int, default=500)
    parser.add_argument("--size", default="64x36", metavar="WxH", help="of images, pixels")
    parser.add_argument(
        "--slack", type=float, default=0.0, help="MiB of the process that count as flat"
    )
    parser.add_argument(
        "--technique", action="append", choices=list(TECHNIQUES), help="only this one, or these"
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
