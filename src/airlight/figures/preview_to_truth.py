"""From preview to truth: a still of more and more samples beside a path tracer's at equal time.

Time is that of all processors together, so that other work on the machine does not count. Of both,
what is done once is not in it: compiling, loading, and what Mitsuba takes to begin.
"""

from __future__ import annotations

import dataclasses
import os
import time
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from ..app.compare.reference import reference_for
from ..reference import mitsuba
from ..scene.builtin import cornell, room
from ..scene.checks import F32
from ..scene.image import Image
from ..scene.scene import Scene
from .panels import Drawn, Request, away, exposed, exposure_of, renderer, sheet

SAMPLES = (1, 4, 16, 64, 256)
ASKED = (0.1, 0.05)
"""Relative L2 of the whole image: how long each takes to come there is told."""
PROBE_SPP, QUICK_SPP = 128, 16
TRUTH_SPP = 1024
MOST_SPP = 4096
CLAMPED = 99.5
"""Percentile of the truth at which images are clamped, so that a few bright pixels do not rule."""

T = TypeVar("T")


def draw(request: Request) -> Drawn:
    """`builtin:room`, at half of a panel's size."""
    scene = cornell() if request.quick else room()
    counts = SAMPLES[:2] if request.quick else SAMPLES

    # Half a panel's size: the path tracer is to reach many samples.
    small = dataclasses.replace(request, size=(request.size[0] // 2, request.size[1] // 2))
    spp, most = (QUICK_SPP, QUICK_SPP) if request.quick else (TRUTH_SPP, MOST_SPP)
    truth = reference_for(scene, small.size, spp, report=request.report)
    light = truth.image.radiance
    ours: list[tuple[str, F32]] = []
    theirs: list[tuple[str, F32]] = []
    curve = []

    # One renderer for all counts; its first frame compiles.
    with renderer(small, scene, {"gather": "always"}) as made:
        made.frame(read=False)

        # What Mitsuba takes for each sample, so that it can be given the same time.
        fixed_s, rate_s = _pace(small, scene)
        for index, count in enumerate(counts):
            request.report(f"{count} samples", index / len(counts))
            cpu_s, image = _timed(lambda count=count: made.frame(samples=count))  # type: ignore[misc]
            assert image is not None

            # As many samples as fit into the time that ours took.
            wanted = min(max(mitsuba.MIN_SPP, round(cpu_s / rate_s)), most)
            traced_s, traced = _timed(lambda wanted=wanted: _traced(small, scene, wanted))  # type: ignore[misc]
            row = {
                "samples": count,
                "cpu_s": cpu_s,
                "relative_l2": _off(image.radiance, light),
                "mitsuba_spp": wanted,
                "mitsuba_cpu_s": max(traced_s - fixed_s, rate_s),
                "mitsuba_relative_l2": _off(traced.radiance, light),
            }
            curve.append(row)
            ours.append((_told(count, row["cpu_s"], row["relative_l2"]), image.radiance))
            of_theirs = (wanted, row["mitsuba_cpu_s"], row["mitsuba_relative_l2"])
            theirs.append((_told(*of_theirs), traced.radiance))

    # All exposed as the truth.
    stops = exposure_of(scene, light)
    rows: list[Any] = [
        ("airlight", exposed(ours, stops)),
        ("Mitsuba", exposed(theirs, stops)),
        ("truth", exposed([(f"{truth.spp} samples", light)], stops)),
    ]
    numbers: dict[str, Any] = {"scene": scene.name, "size": list(small.size), "curve": curve}
    numbers |= {f"seconds to {asked:g}": _race(curve, asked) for asked in ASKED}
    return Drawn(sheet(request, "From preview to truth", rows), numbers)


def _told(samples: int, cpu_s: float, off: float) -> str:
    return f"{samples} samples, {cpu_s:.3g} s, relative L2 {off:.3f}"


def _traced(request: Request, scene: Scene, spp: int) -> Image:
    """The whole image of `spp` samples. Its seed is not the truth's."""
    images = mitsuba.render_layers(
        scene,
        ("all",),
        size=request.size,
        spp=spp,
        seed=1 << 20,
        timeout_s=3600.0,
        progress=lambda done: None,
    )
    return images["all"]


def _pace(request: Request, scene: Scene) -> tuple[float, float]:
    """Seconds that Mitsuba takes to begin, and for each further sample a pixel."""
    # Two counts of samples part the fixed time from that of each sample.
    few_s, _ = _timed(lambda: _traced(request, scene, mitsuba.MIN_SPP))
    spp = QUICK_SPP if request.quick else PROBE_SPP
    more_s, _ = _timed(lambda: _traced(request, scene, spp))
    rate_s = max((more_s - few_s) / (spp - mitsuba.MIN_SPP), 1e-6)
    return max(few_s - mitsuba.MIN_SPP * rate_s, 0.0), rate_s


def _timed(work: Callable[[], T]) -> tuple[float, T]:
    """Seconds of this process and of its children on all processors."""
    # Processor time of this process and its children.
    before, begin_s = os.times(), time.perf_counter()
    made = work()
    after, wall_s = os.times(), time.perf_counter() - begin_s
    cpu_s = sum(after[:4]) - sum(before[:4])
    # A GPU works while processors wait.
    return max(cpu_s, wall_s if cpu_s < 0.1 * wall_s else 0.0, 1e-3), made


def _off(radiance: F32, truth: F32) -> float:
    """Relative L2, both clamped where the truth's brightest pixels begin."""
    # Clamped, so that a few bright pixels do not rule the error.
    most = np.percentile(truth, CLAMPED)
    clamped = np.minimum(truth, most).astype(np.float64)
    return away(np.minimum(radiance, most), clamped)


def _race(curve: Sequence[dict[str, Any]], asked: float) -> dict[str, float | None]:
    """When each is so near first; None where it is not."""
    ours = reached([row["cpu_s"] for row in curve], [row["relative_l2"] for row in curve], asked)
    theirs = reached(
        [row["mitsuba_cpu_s"] for row in curve],
        [row["mitsuba_relative_l2"] for row in curve],
        asked,
    )
    ratio = theirs / ours if ours is not None and theirs is not None else None
    return {"airlight": ours, "Mitsuba": theirs, "times faster": ratio}


def reached(seconds: Sequence[float], errors: Sequence[float], asked: float) -> float | None:
    """When errors that fall have come down to `asked`: a power law between two that were measured.

    None where they do not; the first time where they are there already.
    """
    for index, (second, error) in enumerate(zip(seconds, errors, strict=True)):
        if error > asked:
            continue
        if index == 0:
            return second

        # Between two measurements the error falls as a power of time.
        earlier, more = seconds[index - 1], errors[index - 1]
        share = np.log(more / asked) / np.log(more / max(error, 1e-9))
        return float(earlier * (second / earlier) ** share)
    return None
