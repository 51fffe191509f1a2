"""The report's parts, as Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from airlight.app.bench.tables import Table, milliseconds, table_markdown
from airlight.gpu.asked import DEFAULT_LIMITS, FEATURES
from airlight.gpu.device import Gpu

from .tests_on_device import Outcome


def device_page(gpu: Gpu) -> str:
    """Its name, driver, features and limits."""
    info = gpu.info
    about = [
        f"- device: {info.name} ({info.adapter_type}), vendor {info.vendor or 'unnamed'}",
        f"- driver: {info.driver or 'unnamed'} ({info.backend})",
        f"- code paths: {gpu.paths.name}",
        *(f"- feature {name}: {'yes' if name in gpu.features else 'no'}" for name in FEATURES),
    ]
    rows = [
        (name, str(gpu.limits[name]), str(default))
        for name, default in DEFAULT_LIMITS.items()
        if name in gpu.limits
    ]
    table = Table("Limits", ("limit", "asked for and had", "WebGPU's default"), tuple(rows))
    return "\n".join(["## Device", "", *about, "", table_markdown(table)])


def tests_page(outcomes: Sequence[Outcome]) -> str:
    """How many tests passed, and which failed."""
    lines = ["## Tests", ""]
    for found in outcomes:
        lines.append(f"- paths of {found.paths}: {found.last_line}")
        lines += [f"  - {name}" for name in found.failed]
    return "\n".join(lines)


def paths_page(
    found: Mapping[str, Mapping[str, float]], ceilings: Mapping[str, Mapping[str, Any]]
) -> str:
    """How far the images of both code paths are from one another."""
    rows = []
    for case, layers in found.items():
        for layer, off in layers.items():
            most = ceilings[case][layer]
            rows.append((f"{case}: {layer}", f"{off:.4f}", f"{most:.3f}", _verdict(off <= most)))
    columns = ("case", "off", "at most", "")
    table = Table("Relative L2 of the GPU's paths from the CPU's", columns, tuple(rows))
    return f"## Both code paths\n\n{table_markdown(table)}"


def frames_page(cases: Sequence[Mapping[str, Any]]) -> str:
    """What frames cost with lights and camera moving, and each stage beside what it handles."""
    rows = []
    for c in cases:
        frame, python = c["flying_ms"]["median"], c["python_ms"]["median"]
        rows.append(
            (
                c["name"],
                c["technique"],
                "x".join(map(str, c["size"])),
                milliseconds(frame),
                milliseconds(c["flying_ms"]["min"]),
                milliseconds(python),
                f"{python / frame:.0%}",
            )
        )
    columns = ("case", "technique", "size", "frame, ms median", "min", "Python, ms", "share")
    title = "Frames, lights and camera moving"
    told = (
        "Bytes are of all that a stage's passes bind, once for each pass; invocations are threads, "
        "pixels of whole images and vertices. GB/s and G/s divide them by the stage's time."
    )
    parts = ["## Frames", table_markdown(Table(title, columns, tuple(rows))), told]
    return "\n\n".join([*parts, *(table_markdown(_stages(c)) for c in cases)])


def _stages(case: Mapping[str, Any]) -> Table:
    """Time beside bytes and invocations; nothing where nothing could be counted."""
    rows = []
    for name in {**case["passes"], **case["counts"]}:
        ms, count = case["passes"].get(name, 0.0), case["counts"].get(name, {})
        nbytes, threads = count.get("nbytes", 0), count.get("invocations", 0)
        rows.append(
            (
                name,
                milliseconds(ms),
                str(count.get("passes", 0)),
                f"{nbytes / 1e6:.3g}",
                f"{threads / 1e6:.3g}",
                _rate(nbytes, ms),
                _rate(threads, ms),
            )
        )
    columns = ("stage", "ms", "passes", "bound, MB", "million invocations", "GB/s", "G/s")
    return Table(f"Stages of {case['name']}", columns, tuple(rows))


def _rate(amount: int, ms: float) -> str:
    """In 10^9 a second."""
    return f"{amount / ms / 1e6:.3g}" if amount and ms > 0.0 else "-"


def _verdict(is_good: bool) -> str:
    return "" if is_good else "**over**"
