"""Hold the code paths of GPUs to those of CPUs, on one adapter.

    python tests/kept/measure_paths.py [CASE ...]

Prints a line of paths.toml for each case: how far the layers are from one another (relative L2).
"""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from airlight.gpu.code_paths import SWITCH
from airlight.rendering import Renderer
from airlight.scene.builtin import builtin_scene
from airlight.scene.image import Image

CEILINGS = Path(__file__).with_name("paths.toml")
SIZE, SAMPLES = (160, 90), 2
_FEW = {"sky_lights": 32, "surfels": 50_000}
QUICK_SETTINGS = {
    **{name: {**_FEW, "resolution": 16} for name in ("lpv", "lpv-scatter", "auto")},
    "pop": {**_FEW, "virtual_lights": 0, "ordinates": 16},
}
"""Of quick cases: most of the time went into their lattices."""
SETTINGS = {"pop": {"virtual_lights": 0}}
"""Virtual lights are texels of maps: one that flips is a larger step than what is asked here."""
LAYERS = ("direct", "indirect", "single_scatter", "multiple_scatter")


def read_cases() -> dict[str, Any]:
    """ "SCENE TECHNIQUE" -> {is_slow, layer: the most it may be off, ...}."""
    return tomllib.loads(CEILINGS.read_text(encoding="utf-8"))


def both(case: str, setenv: Any) -> tuple[Image, Image]:
    """The images of a case on the paths of GPUs and of CPUs; `setenv(name, value)` switches."""
    scene, technique = case.split()
    is_slow = read_cases()[case].get("is_slow", False)
    settings = (SETTINGS if is_slow else SETTINGS | QUICK_SETTINGS).get(technique, {})
    loaded, found = builtin_scene(scene), []
    for paths in ("gpu", "cpu"):
        setenv(SWITCH, paths)
        with Renderer(loaded, technique, SIZE, settings=settings) as renderer:
            found.append(renderer.frame(samples=SAMPLES))
            assert renderer.stats()["paths"] == paths
    return found[0], found[1]


def distances(gpu: Image, cpu: Image) -> dict[str, float]:
    """Relative L2 of the GPU's image from the CPU's, and of each lit layer."""
    pairs = {"radiance": (gpu.radiance, cpu.radiance)}
    pairs |= {name: (gpu.layers[name], cpu.layers[name]) for name in LAYERS if name in cpu.layers}
    return {name: _relative_l2(a, b) for name, (a, b) in pairs.items() if b.any()}


def _relative_l2(a: np.ndarray, b: np.ndarray) -> float:
    a, b = a.astype(np.float64), b.astype(np.float64)
    return float(np.sqrt(((a - b) ** 2).sum() / (b**2).sum()))


def main() -> None:
    import os

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help='"SCENE TECHNIQUE"')
    for case in parser.parse_args().cases or read_cases():
        off = distances(*both(case, os.environ.__setitem__))
        inside = ", ".join(f"{name} = {value:.4f}" for name, value in off.items())
        print(f'"{case}" = {{ {inside} }}', flush=True)


if __name__ == "__main__":
    main()
