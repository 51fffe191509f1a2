"""A rendered image: scene-referred radiance and its layers."""

from __future__ import annotations

import io
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from ..errors import OutputError, SettingsError, nearest
from ..maths.lut import Lut
from ..maths.tone import display_srgb8
from .checks import F32, MOST_PX, path_text, shown

MAX_SIDE_PX = MOST_PX
MOST_SAMPLES = 4096


@dataclass(frozen=True, eq=False)
class Image:
    """Linear Rec.709 radiance, W m^-2 sr^-1, (H, W, 3) float32, top row first.

    `layers` are (H, W, 3) or (H, W) float32: direct, indirect, single_scatter,
    multiple_scatter, transmittance, depth (metres along the view ray), normal (world),
    albedo. The radiance layers sum to `radiance`. `exposure_stops` and `tone_map` say how a
    display-referred file is made of it, and `lut`, the table of `graded`, which display values
    are looked up in after the curve. `stats` are what the renderer measured of itself.
    """

    radiance: F32
    layers: Mapping[str, F32] = field(default_factory=dict)
    exposure_stops: float = 0.0
    tone_map: str = "agx"
    stats: Mapping[str, Any] = field(default_factory=dict)
    lut: Lut | None = None

    @property
    def doubts(self) -> tuple[str, ...]:
        """Warnings of pixels that are NaN or infinite, which files show as black or as white."""
        # A pixel is counted once, whichever of its channels is wrong.
        count = int((~np.isfinite(self.radiance)).any(axis=-1).sum())
        if not count:
            return ()
        total = self.radiance[..., 0].size
        return (
            f"{count:,} of {total:,} pixels are NaN or infinite: a light, a coefficient or a size "
            "in the scene is too large or too small",
        )

    def save(self, path: str | Path, *, layers: bool = True) -> None:
        """Write to `path` EXR (linear, with layers), HDR, or tone-mapped PNG/JPEG by its ending.

        The file appears whole or not at all. Raises OutputError.
        """
        from .io.images import save_image

        try:
            file = Path(os.fsdecode(path))
        except TypeError:
            raise OutputError(f"an image is saved to a path, not {shown(path)}") from None
        save_image(self, file, layers=layers)

    def display(self, layer: str = "") -> NDArray[np.uint8]:
        """As on a screen, 8-bit sRGB (H, W, 3): the image, or a colour layer exposed as it is.

        Dithered by half a code value, as files are.
        Raises SettingsError for a layer that it does not have or that is no colour.
        """
        pixels = self.layers.get(layer) if layer else self.radiance
        # Layers of scalars, such as depth, have no colours to show.
        if pixels is None or pixels.ndim != 3:
            colours = [name for name, values in self.layers.items() if values.ndim == 3]
            raise SettingsError(
                f"the image has no colour layer '{layer}'", remedy=nearest(layer, colours)
            )
        return display_srgb8(pixels, self.exposure_stops, self.tone_map, lut=self.lut, dither=True)

    def graded(self, path: str | Path) -> Image:
        """The image whose display goes through the .cube table of colours at `path`.

        The table, of one dimension or three, takes and gives display values: after the tone curve,
        encoded as sRGB. Linear files (EXR, HDR) stay as they are. Raises SceneError.
        """
        from .io.cube import read_cube

        return replace(self, lut=read_cube(Path(path_text(path, "a table of colours"))))

    def denoised(self) -> Image:
        """The image without the noise of gathered light, by Intel's Open Image Denoise.

        Its layers `indirect` and `multiple_scatter` are denoised, by its albedo and normals, and
        the image by as much; one without these layers is denoised as a whole.
        Raises SettingsError where the extra `denoise` is not installed.
        """
        from .denoise import denoised

        return denoised(self)

    def _repr_png_(self) -> bytes:
        """What a notebook shows."""
        held = io.BytesIO()
        PIL.Image.fromarray(self.display()).save(held, "PNG")
        return held.getvalue()


def checked_samples(samples: int) -> int:
    """How many jittered images are averaged. Raises SettingsError for an impossible number."""
    if isinstance(samples, bool) or not isinstance(samples, (int, np.integer)):
        raise SettingsError(f"samples must be a whole number, not {shown(samples)}")
    if not 1 <= samples <= MOST_SAMPLES:
        raise SettingsError(
            f"samples = {samples} is out of range", remedy=f"It goes from 1 to {MOST_SAMPLES}"
        )
    return int(samples)


def checked_size(size: Sequence[int]) -> tuple[int, int]:
    """(width, height) in pixels. Raises SettingsError for an impossible one."""
    values = tuple(size) if isinstance(size, Iterable) else ()
    if len(values) != 2 or any(not isinstance(v, (int, np.integer)) for v in values):
        raise SettingsError(f"size must be two whole numbers, not {size!r}")
    if any(not 1 <= v <= MAX_SIDE_PX for v in values):
        raise SettingsError(
            f"size {values[0]}x{values[1]} is impossible",
            remedy=f"Each side goes from 1 to {MAX_SIDE_PX} pixels",
        )
    return (int(values[0]), int(values[1]))
