"""Render the references that tests/kept compares every technique with.

    python benchmarks/make_references.py [NAME ...] [--folder DIR]

Needs the `reference` extra. What is rendered goes through the cache of `airlight compare`, so an
interrupted run goes on where it was. Prints the noise floor of every layer.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from airlight.app.compare.reference import reference_for
from airlight.reference.metrics import compare
from airlight.reference.stored import SIZE_PX, STORED, load_stored, save_stored

FOLDER = Path(__file__).parents[1] / "tests" / "kept"


def make(name: str, folder: Path) -> None:
    """Render, write and judge one reference."""
    kept = STORED[name]
    reference = reference_for(kept.load(), SIZE_PX, kept.spp)
    path = folder / f"{name}.exr"
    save_stored(
        reference.image,
        path,
        stats={"spp": reference.spp, "notes": list(reference.notes)},
    )
    again = load_stored(path)
    scores = compare(again, again, perceptual=False)
    layers = {"whole": scores, **scores.layers}
    floors = ", ".join(f"{k} {m.noise_floor_l2 or 0.0:.4f}" for k, m in layers.items())
    size_kb = path.stat().st_size // 1024
    print(
        f"{name}: {reference.spp} spp, {reference.seconds:.0f} s, {size_kb} kB; "
        f"noise floor as relative L2: {floors}",
        flush=True,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(STORED)}")
    parser.add_argument("--folder", type=Path, default=FOLDER)
    given = parser.parse_args()
    unknown = [name for name in given.names if name not in STORED]
    if unknown:
        parser.error(f"no kept reference is called {', '.join(unknown)}")
    for name in given.names or STORED:
        make(name, given.folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
