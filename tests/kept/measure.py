"""Measure every technique against the kept references.

    python tests/kept/measure.py [SCENE ...] [--technique NAME ...] [--write]

Prints the table of docs/accuracy.md. With --write, ceilings.toml beside this file is lowered to
what was measured, and what is new is added; a ceiling is never raised.
"""

from __future__ import annotations

import argparse
import dataclasses
import datetime
import math
import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from airlight.app.compare.judging import render_technique
from airlight.errors import AirlightError
from airlight.maths.colour import luminance
from airlight.reference.metrics import Metrics, compare
from airlight.reference.stored import STORED, load_stored
from airlight.scene import Scene
from airlight.scene.image import Image
from airlight.techniques import TECHNIQUES

FOLDER = Path(__file__).parent
CEILINGS = FOLDER / "ceilings.toml"
SHRINK = 2  # images of 96 x 54: quick, and a quarter of the references' noise
SAMPLES = 8
GATHERED = {"gather_rays": 16, "gather_air": 8}
"""As many rays as the ceilings were measured with; by default samples are more, of half as many."""
ALIKE = {"single": "direct", "pop": "direct", "lpv-march": "lpv", "lpv-sum": "lpv", "auto": "lpv"}
"""Techniques that are another one where there is no air."""
ERRORS = ("relative_l2", "energy_error")
GATHERS = ("lpv", "lpv-scatter", "auto")


@dataclasses.dataclass(frozen=True)
class Score:
    """Of one layer: relative L2 and its noise floor, energy ratio, FLIP (of the whole alone).

    `brightest`: its brightest pixel over the truth's 99.9th percentile, in luminance.
    """

    relative_l2: float
    energy_ratio: float
    noise_floor: float
    flip: float | None = None
    brightest: float = 0.0

    @property
    def energy_error(self) -> float:
        """How far the energy ratio is from 1."""
        return abs(self.energy_ratio - 1.0)


def techniques_for(scene: Scene) -> list[str]:
    """Those that differ on this scene."""
    has_air = scene.medium is not None or bool(scene.volumes)
    return [name for name in TECHNIQUES if has_air or name not in ALIKE]


def measure(name: str, technique: str, *, perceptual: bool = False) -> dict[str, Score]:
    """The scores of a technique on a kept scene, by layer, with `GATHERED`."""
    scene = STORED[name].load()
    reference = load_stored(FOLDER / f"{name}.exr", shrink=SHRINK)
    size = (reference.radiance.shape[1], reference.radiance.shape[0])
    settings = GATHERED if technique in GATHERS else {}
    image, _ = render_technique(scene, technique, size, SAMPLES, settings=settings)
    whole = compare(image, reference, perceptual=perceptual)
    scores = {"whole": whole, **whole.layers}
    return {
        layer: dataclasses.replace(_score(m), brightest=brightest(image, reference, layer))
        for layer, m in scores.items()
        if _is_lit(reference, layer)
    }


def brightest(image: Image, reference: Image, layer: str) -> float:
    """The brightest pixel of a layer over the reference's 99.9th percentile, in luminance.

    A path tracer's own brightest pixels may be noise: the percentile leaves five of 5184 out.
    """
    pair = (i.radiance if layer == "whole" else i.layers[layer] for i in (image, reference))
    ours, theirs = (luminance(pixels) for pixels in pair)
    return float(ours.max() / max(np.percentile(theirs, 99.9), 1e-9))


def _is_lit(reference: Image, layer: str) -> bool:
    return layer == "whole" or bool(reference.layers[layer].any())


def _score(m: Metrics) -> Score:
    return Score(m.relative_l2 or 0.0, m.energy_ratio or 0.0, m.noise_floor_l2 or 0.0, m.flip)


def read_ceilings() -> dict[str, Any]:
    """scene -> technique -> layer -> those of `ERRORS` that `held` names."""
    return tomllib.loads(CEILINGS.read_text(encoding="utf-8")) if CEILINGS.exists() else {}


def held(scores: dict[str, Score]) -> dict[str, tuple[str, ...]]:
    """The errors of each layer that say something of a technique.

    A layer that it does not draw is off by all of its light, whatever the technique does. The
    whole then lacks that light, and too much of another layer would bring its energy nearer to
    the truth: only its relative L2 is held.
    """
    drawn = [name for name, score in scores.items() if score.energy_ratio > 0.0]
    errors = {name: ERRORS for name in drawn}
    if len(drawn) < len(scores):
        errors["whole"] = ("relative_l2",)
    return errors


def lowered(ceilings: dict[str, Any], name: str, technique: str, scores: dict[str, Score]) -> None:
    """Put what was measured into the table wherever it is lower, or new.

    5 % and .005 more than measured: drivers round otherwise.
    """
    entry = ceilings.setdefault(name, {}).setdefault(technique, {})
    is_new = False
    for layer, errors in held(scores).items():
        old = entry.setdefault(layer, {})
        for key in errors:
            # Rounded first, lest .215 written in binary become .216.
            new = math.ceil(round(1050.0 * getattr(scores[layer], key) + 5.0, 6)) / 1000.0
            if new < old.get(key, math.inf):
                old[key], is_new = new, True
    if is_new:
        entry["measured"] = datetime.date.today()


def as_toml(ceilings: dict[str, Any]) -> str:
    """The table as text."""
    lines = [
        "# What each technique may be off the kept references at most, by scene and layer.",
        "# Measured by measure.py beside this file, plus 5 % and .005; a ceiling may only fall.",
    ]
    for name, by_technique in ceilings.items():
        for technique, layers in by_technique.items():
            lines += ["", f"[{name}.{technique}]", f"measured = {layers['measured']}"]
            for layer, c in layers.items():
                if layer != "measured":
                    errors = ", ".join(f"{key} = {c[key]:.3f}" for key in ERRORS if key in c)
                    lines.append(f"{layer} = {{ {errors} }}")
    return "\n".join(lines) + "\n"


COLUMNS = ("direct", "one_bounce", "indirect", "single_scatter", "multiple_scatter", "whole")


def row(name: str, technique: str, scores: dict[str, Score]) -> str:
    """A line of the table: energy ratio / relative L2 (noise floor) by layer, FLIP."""
    cells = [name, technique]
    for column in COLUMNS:
        s = scores.get(column)
        cells.append(
            f"{s.energy_ratio:.2f} / {s.relative_l2:.3f} ({s.noise_floor:.3f})" if s else ""
        )
    flip = scores["whole"].flip
    return "| " + " | ".join([*cells, f"{flip:.3f}" if flip is not None else ""]) + " |"


def run(names: Iterable[str], wanted: list[str], *, write: bool) -> None:
    """Measure, print, and perhaps write."""
    ceilings = read_ceilings()
    heads = ("scene", "technique", *COLUMNS, "FLIP")
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    for name in names:
        for technique in wanted or techniques_for(STORED[name].load()):
            try:
                scores = measure(name, technique, perceptual=True)
            except AirlightError as error:
                print(f"{name} {technique}: {error}", file=sys.stderr, flush=True)
                continue
            print(row(name, technique, scores), flush=True)
            lowered(ceilings, name, technique, scores)
            if write:
                CEILINGS.write_text(as_toml(ceilings), encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join(STORED)}")
    parser.add_argument("--technique", nargs="+", default=[], choices=list(TECHNIQUES))
    parser.add_argument("--write", action="store_true", help="lower the ceilings")
    given = parser.parse_args()
    if unknown := [name for name in given.scenes if name not in STORED]:
        parser.error(f"no kept reference is called {', '.join(unknown)}")
    run(given.scenes or STORED, given.technique, write=given.write)


if __name__ == "__main__":
    main()
