"""What a benchmark found, as tables: on a terminal, or as Markdown for docs/performance.md."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

_STAGES_SHOWN = 8


@dataclass(frozen=True)
class Table:
    """A title, the columns' names, and rows of text."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def tables(results: Mapping[str, Any]) -> list[Table]:
    """Every table that `results`, as `airlight bench -o` writes them, have numbers for."""
    found: list[Table] = []
    # Only parts that were measured have a table.
    if results.get("frames"):
        found += [_frames(results["frames"]), _stages(results["frames"])]
    if results.get("propagation"):
        found.append(_propagation(results["propagation"], "propagation steps"))
    if results.get("first_image"):
        found.append(_first_images(results["first_image"]))
    found += [_growth(table) for table in results.get("growth", ())]
    if results.get("pop"):
        found += pop_tables(results["pop"])
    if results.get("rays"):
        found.append(_rays(results["rays"]))
    return found


def heading(results: Mapping[str, Any]) -> str:
    """The machine in one line."""
    m = results["machine"]
    return (
        f"airlight {m['airlight']} on {m['device']} ({m['adapter_type']}, {m['backend']}, "
        f"{m['paths']} paths), "
        f"{m['cpu_cores']} CPU cores, Python {m['python']}, {m['system']}"
    )


def markdown(results: Mapping[str, Any]) -> str:
    """All tables for a page."""
    parts = [heading(results), *(table_markdown(table) for table in tables(results))]
    return "\n\n".join(parts) + "\n"


def show(results: Mapping[str, Any], console: Console) -> None:
    """All tables on a terminal."""
    from rich import box
    from rich.table import Table as RichTable

    console.print(heading(results))
    for table in tables(results):
        drawn = RichTable(
            title=table.title, box=box.SIMPLE_HEAD, title_justify="left", title_style="bold"
        )
        for index, column in enumerate(table.columns):
            drawn.add_column(column, justify="right" if index else "left")
        for row in table.rows:
            drawn.add_row(*row)
        console.print(drawn)


def table_markdown(table: Table) -> str:
    """For a page."""

    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cells) + " |"

    # The first column is text, all others are numbers.
    rule = ["---", *["---:"] * (len(table.columns) - 1)]
    rows = [line(table.columns), line(rule), *map(line, table.rows)]
    return f"**{table.title}**\n\n" + "\n".join(rows)


def milliseconds(value: float) -> str:
    """Three digits, and never an exponent."""
    return f"{value:.3g}" if value < 999.5 else f"{value:,.0f}"


def megabytes(nbytes: int | None) -> str:
    """In units of 10^6 bytes; a dash where it is not known."""
    return "-" if nbytes is None else f"{nbytes / 1e6:.0f}"


def _frames(cases: Sequence[Mapping[str, Any]]) -> Table:
    columns = (
        *("case", "technique", "size", "lattice", "steps", "frame, ms median", "min"),
        *("camera moving, too", "min", "Python, ms", "device memory, MB"),
    )
    rows = []
    for c in cases:
        rows.append(
            (
                c["name"],
                c["technique"],
                _by(c["size"]),
                _by(c["lattice"]),
                str(c["iterations"]),
                milliseconds(c["frame_ms"]["median"]),
                milliseconds(c["frame_ms"]["min"]),
                milliseconds(c["flying_ms"]["median"]),
                milliseconds(c["flying_ms"]["min"]),
                milliseconds(c["python_ms"]["median"]),
                megabytes(c["peak_gpu_bytes"]),
            )
        )
    return Table("Frames in steady state, the light moving", columns, tuple(rows))


def _stages(cases: Sequence[Mapping[str, Any]]) -> Table:
    # Stages of all cases, in the order in which they first come.
    names = list(dict.fromkeys(name for case in cases for name in case["passes"]))
    rows = tuple(
        (name, *(milliseconds(c["passes"][name]) if name in c["passes"] else "-" for c in cases))
        for name in names
    )
    total = ("all", *(milliseconds(sum(c["passes"].values())) for c in cases))
    columns = ("stage", *(c["name"] for c in cases))
    return Table("Stages, ms, each waited for", columns, (*rows, total))


def _propagation(found: Mapping[str, Any], steps: str) -> Table:
    rows = []
    for c in found["cases"]:
        own = c["device_ms"]
        times = [milliseconds(own["median"]), milliseconds(own["min"])]
        # Without C the columns of the yardstick stay empty.
        yardstick = ["-"] * 4
        if "c_ms" in c:
            theirs = c["c_ms"]
            yardstick = [milliseconds(theirs["median"]), milliseconds(theirs["min"])]
            yardstick += [f"{c['ratio_median']:.2f}", f"{c['ratio_min']:.2f}"]
        name = f"{c['side']}^3, {'blocked and bouncing' if c['is_blocked'] else 'empty'}"
        rows.append((name, *times, *yardstick))
    columns = ("lattice", "ours, ms median", "min", "C, ms median", "min", "ratio median", "min")
    title = f"{found['iterations']} {steps} beside C ({found['c']})"
    return Table(title, columns, tuple(rows))


def _first_images(cases: Sequence[Mapping[str, Any]]) -> Table:
    rows = tuple(
        (c["name"], _by(c["size"]), f"{c['seconds']:.2f}", megabytes(c["peak_host_bytes"]))
        for c in cases
    )
    return Table(
        "First image: the whole command in a process of its own",
        ("case", "size", "seconds", "host memory, MB"),
        rows,
    )


def _growth(table: Mapping[str, Any]) -> Table:
    rows = table["rows"]
    # The stages that cost most anywhere along the axis, largest first.
    cost: dict[str, float] = {}
    for row in rows:
        for name, spent_ms in row["passes"].items():
            cost[name] = max(cost.get(name, 0.0), spent_ms)
    names = sorted(cost, key=lambda name: -cost[name])[:_STAGES_SHOWN]
    # A row for each value.
    lines = []
    for row in rows:
        stages = (milliseconds(row["passes"].get(name, 0.0)) for name in names)
        frame = milliseconds(row["flying_ms"]["median"])
        sizes = (str(row["value"]), str(row["cells"]), str(row["triangles"]))
        # Without a time for the first image stands a dash.
        first_s = row.get("first_image_s")
        first = "-" if first_s is None else f"{first_s:.2f}"
        lines.append((*sizes, first, frame, *stages))
    columns = (table["axis"], "cells", "triangles", "first image, s", "frame, ms", *names)
    title = f"Growth with {table['axis']}: {table['scene']} at {_by(table['size'])}"
    return Table(title, columns, tuple(lines))


def pop_tables(found: Mapping[str, Any]) -> list[Table]:
    """Principal ordinates: stages under the paper's names, and growth."""
    cases, paper = found["cases"], found["paper_ms"]
    names = list(cases[0]["stages_ms"])
    # Stages down, cases across, the paper's times beside.
    rows = [
        (n, *(milliseconds(c["stages_ms"][n]) for c in cases), str(paper.get(n, "-")))
        for n in names
    ]
    frame = (milliseconds(c["frame_ms"]["median"]) for c in cases)
    rows.append(("frame", *frame, milliseconds(sum(paper.values()))))
    columns = ("ms", *(c["name"] for c in cases), "paper, GTX 770")
    title = f"Principal ordinates at {_by(found['size'])}, the map turning"
    tables = [Table(title, columns, tuple(rows))]
    # A table for each axis of growth.
    for growth in found["growth"]:
        lines = tuple(
            (
                str(row["value"]),
                milliseconds(row["frame_ms"]["median"]),
                *(milliseconds(row["stages_ms"][n]) for n in names),
            )
            for row in growth["rows"]
        )
        columns = (growth["axis"], "frame, ms", *names)
        tables.append(Table(f"Principal ordinates: growth with {growth['axis']}", columns, lines))
    return tables


def _rays(found: Mapping[str, Any]) -> Table:
    rows = []
    for case in found["cases"]:
        kinds = case["kinds"]
        # Rates by wall time; what a ray costs by processor time, which other work disturbs less.
        per_triangle = case["bytes"] / max(case["triangles"], 1)
        rate = (f"{k['rays'] / max(k['ms'], 1e-6) * 1e-3:.2f}" for k in kinds.values())
        per_ray = (f"{k['cpu_ms'] * 1e6 / max(k['rays'], 1):.0f}" for k in kinds.values())
        sizes = (f"{case['triangles']:,}", f"{per_triangle:.0f}", f"{case['build_s']:.2f}")
        rows.append((case["scene"], *sizes, *rate, *per_ray))
    kinds = list(found["cases"][0]["kinds"])
    columns = (
        *("scene", "triangles", "bytes each", "built in, s of processor"),
        *(f"{kind}, Mray/s" for kind in kinds),
        *(f"{kind}, ns of processor" for kind in kinds),
    )
    return Table(f"Rays, one a pixel of {_by(found['size'])}", columns, tuple(rows))


def _by(size: Sequence[int]) -> str:
    return "x".join(map(str, size))
