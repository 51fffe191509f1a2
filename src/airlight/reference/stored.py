"""References small enough to store with the tests: half-float images with their noise.

A file holds the whole image, the layers `direct`, `one_bounce` and `indirect` (all bounces), and of
each its standard error, averaged over colours, as `NAME_error` (`error` of the whole): variances
are too small for half floats, their roots are not.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from ..errors import ReferenceFailure
from ..scene.builtin import builtin_scene
from ..scene.builtin.sky import clear_sky
from ..scene.checks import F32
from ..scene.image import Image
from ..scene.io import exr
from ..scene.io.writing import whole_file
from ..scene.lights import DirectionalLight
from ..scene.scene import Scene

LAYERS = ("direct", "one_bounce", "indirect")
MEDIUM_LAYERS = ("single_scatter", "multiple_scatter")
SIZE_PX = (192, 108)
_SKY_ROWS = 64


@dataclass(frozen=True)
class StoredScene:
    """A builtin scene with a stored reference, and the samples per pixel it takes."""

    scene: str
    spp: int
    options: Mapping[str, Any] = field(default_factory=dict)

    def load(self) -> Scene:
        """The scene itself, under the sky that its reference was made with."""
        return _as_drawn(builtin_scene(self.scene, **self.options))


def _as_drawn(scene: Scene) -> Scene:
    """`scene` with the background of the stored images: a sky of 64 rows whose horizon blends."""
    # Only the generated sky is replaced; scenes that bring another one keep it.
    directional = [light for light in scene.lights if isinstance(light, DirectionalLight)]
    if not directional or scene.environment is None or scene.environment.source != "clear sky":
        return scene
    sky = clear_sky(directional[0].direction, height_px=_SKY_ROWS)
    return replace(scene, environment=replace(sky, horizon=False))


STORED: dict[str, StoredScene] = {
    "cornell": StoredScene("cornell", 4096),
    "cornell-area": StoredScene("cornell", 4096, {"light": "area"}),
    "wall-floor": StoredScene("wall-floor", 4096),
    "room": StoredScene("room", 2048),
    "atrium": StoredScene("atrium", 2048),
    "haze-box": StoredScene("haze-box", 2048),
}


def save_stored(reference: Image, path: Path, *, stats: Mapping[str, Any]) -> None:
    """Write a reference as `compare` takes it: layers "variance" and "NAME_variance".

    The file appears whole or not at all. Raises OutputError, ReferenceFailure without variance.
    """
    # Layers that hold light, each with its standard error beside it.
    layers = {
        name: reference.layers[name]
        for name in (*LAYERS, *MEDIUM_LAYERS)
        if name in reference.layers and reference.layers[name].any()
    }
    errors = {_error_name(name): _standard_error(reference, name) for name in ("", *layers)}
    image = Image(reference.radiance, {**layers, **errors}, stats=dict(stats))
    with whole_file(path) as part:
        exr.write(image, part, layers=True, half=True)


def load_stored(path: Path, *, shrink: int = 1) -> Image:
    """A kept reference as `compare` takes it, averaged over blocks of `shrink` x `shrink` pixels.

    Averaging is exact: pixels are box filtered. Raises SceneError for a broken file,
    ReferenceFailure for a size that `shrink` does not divide.
    """
    image = exr.read(path)
    if any(side % shrink for side in image.radiance.shape[:2]):
        raise ReferenceFailure(f"{path.name} cannot be shrunk {shrink} times")
    layers: dict[str, F32] = {}
    for name, pixels in image.layers.items():
        if name == "error" or name.endswith("_error"):
            # Of the mean of n independent pixels: the mean variance over n.
            variance = _blocks(np.square(pixels), shrink) / np.float32(shrink * shrink)
            layers[name.removesuffix("error") + "variance"] = variance
        else:
            layers[name] = _blocks(pixels, shrink)
    return Image(_blocks(image.radiance, shrink), layers, stats=image.stats)


def _error_name(layer: str) -> str:
    return f"{layer}_error" if layer else "error"


def _standard_error(reference: Image, layer: str) -> F32:
    key = f"{layer}_variance" if layer else "variance"
    if key not in reference.layers:
        raise ReferenceFailure(f"the reference has no layer '{key}'")
    variance = reference.layers[key]
    mean = variance.mean(axis=-1) if variance.ndim == 3 else variance
    return cast(F32, np.sqrt(mean).astype(np.float32))


def _blocks(pixels: F32, side: int) -> F32:
    """Means over blocks of side x side pixels."""
    height, width = pixels.shape[:2]
    parts = pixels.reshape(height // side, side, width // side, side, *pixels.shape[2:])
    return cast(F32, parts.mean(axis=(1, 3), dtype=np.float32))
