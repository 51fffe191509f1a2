"""What a soak measures: memory of the process and of the device, and wgpu's objects by kind."""

from __future__ import annotations

import gc
import resource
import statistics
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import wgpu

from airlight.gpu.device import Gpu

FLAT = 0.01
"""The share that a level may grow by."""
FILLING = 16
"""Objects of a kind that may come: caches of the last few of something fill up as they are used."""
SHORT_LIVED = ("CommandBuffer", "CommandEncoder", "ComputePassEncoder", "RenderPassEncoder")


@dataclass(frozen=True)
class Level:
    """At one moment: bytes of the process that lie in memory, bytes on the device, objects."""

    process: int
    device: int
    objects: dict[str, int]


def level(gpu: Gpu) -> Level:
    """The level now, with what Python can free freed."""
    gc.collect()
    gpu.wait()
    return Level(resident_bytes(), gpu.allocated_bytes, objects_now())


def objects_now() -> dict[str, int]:
    """How many objects there are of each kind: wgpu-py's, and those that wgpu-native keeps."""
    held = wgpu.diagnostics.object_counts.get_dict()
    kept = wgpu.diagnostics.wgpu_native_counts.get_dict()
    ours = {kind: int(row["count"]) for kind, row in held.items() if kind not in SHORT_LIVED}
    native = {f"native {kind}": int(row["count"]) for kind, row in kept.items()}
    return {kind: n for kind, n in {**ours, **native}.items() if not kind.endswith("total")}


def resident_bytes() -> int:
    """Bytes of this process in memory; where the system does not say, the most there were."""
    statm = Path("/proc/self/statm")
    if statm.exists():
        return int(statm.read_text().split()[1]) * resource.getpagesize()
    scale = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale


@dataclass(frozen=True)
class Course:
    """Levels taken one after the other, warm-up left out; `slack` bytes are no growth."""

    name: str
    levels: Sequence[Level]
    slack: int = 0

    def grown(self) -> list[str]:
        """What grew, in words; nothing where all is flat.

        The process is judged by the medians of the first and the last third: its allocator hands
        pages back when it likes. Everything else is counted, and judged by the ends.
        """
        found = []
        before, after = self.process_bytes()
        if after - before > max(FLAT * before, self.slack):
            found.append(f"memory of the process {_mib(before)} -> {_mib(after)}")
        first, last = self.levels[0], self.levels[-1]
        if last.device > first.device * (1.0 + FLAT):
            found.append(f"memory of the device {_mib(first.device)} -> {_mib(last.device)}")
        for kind, count in last.objects.items():
            had = first.objects.get(kind, 0)
            if count > max(had * (1.0 + FLAT), had + FILLING):
                found.append(f"{kind} objects {had} -> {count}")
        return found

    def process_bytes(self) -> tuple[float, float]:
        """Medians of the first and of the last third."""
        third = max(len(self.levels) // 3, 1)
        held = [now.process for now in self.levels]
        return statistics.median(held[:third]), statistics.median(held[-third:])

    def line(self) -> str:
        """One line of the report."""
        before, after = self.process_bytes()
        first, last = self.levels[0], self.levels[-1]
        share = 100.0 * (after - before) / before
        totals = sum(first.objects.values()), sum(last.objects.values())
        return (
            f"{self.name}: process {_mib(before)} -> {_mib(after)} ({share:+.2f} %), device "
            f"{_mib(first.device)} -> {_mib(last.device)}, objects {totals[0]} -> {totals[1]}"
        )


def _mib(count: float) -> str:
    return f"{count / 2**20:.1f} MiB"
