"""Cached lattice coordinates and sky light of each pixel, on CPU adapters.

Both depend only on the image's surfaces, the lattice's walls and the sky, and are a third of the
time of the lattice's light. The second image in a row with the same of them fills the cache; the
first computes them as it goes, with the same bits.
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any, ClassVar

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..gpu.raster import FullscreenPass
from ..gpu.slots import Slot
from .kernel import (
    CACHED,
    IMAGE_SAMPLER,
    LATTICE_SLOTS,
    SURFACE_SLOTS,
    TRACED_INLINE,
    TRACED_SEPARATELY,
    Gloss,
    LatticeLight,
)

_BYTES = 36  # of a pixel of all targets


def can_cache(gpu: Gpu) -> bool:
    """Whether a device caches them: CPU adapters do, where they have enough colour targets."""
    return gpu.takes_cpu_paths and gpu.limits["max-color-attachment-bytes-per-sample"] >= _BYTES


class _CoordinatesPass(FullscreenPass):
    slots: ClassVar[tuple[Slot, ...]] = (
        *SURFACE_SLOTS,
        IMAGE_SAMPLER,
        *LATTICE_SLOTS,
    )
    targets = ("rgba32float", "rgba32float", "r32float")
    file = "lattice_coordinates.wgsl"


class LatticeCoordinates:
    """The cache for one image and one lattice."""

    def __init__(self, gpu: Gpu, lattices: LatticeLight, gloss: Gloss) -> None:
        """As for `Lighting`."""
        self.gpu = gpu
        self._pass = _CoordinatesPass(
            gpu,
            generated=TRACED_SEPARATELY if gloss == "listed" else TRACED_INLINE,
            firsts={"lattices": ()},
            constants={**lattices.constants, "IS_SAMPLED": float(gpu.takes_cpu_paths)},
        )
        self._targets: tuple[Texture, ...] = ()
        self._last: Hashable = None
        self._cached: Hashable = None

    def encode(
        self, commands: Commands, size: tuple[int, int], key: Hashable, values: dict[str, Any]
    ) -> dict[str, Texture] | None:
        """The textures that "cached" `Lighting` binds.

        None for a first image of that `size` (pixels) and `key`. `values` as `Lighting` draws them.
        """
        before, self._last = self._last, (size, key)
        if self._last != before:
            return None
        if self._last != self._cached:
            self._fit(size)
            names = {slot.name for slot in self._pass.slots}
            bound = {name: value for name, value in values.items() if name in names}
            self._pass.draw(commands, self._targets, **bound)
            self._cached = self._last  # last: what raised before drew nothing
        return dict(zip(CACHED, self._targets, strict=True))

    def _fit(self, size: tuple[int, int]) -> None:
        if self._targets and self._targets[0].size[:2] == size:
            return
        for target in self._targets:
            target.release()
        self._targets, self._cached = (), None
        self._targets = tuple(
            Texture(self.gpu, label, size, format, target=True)
            for label, format in zip(CACHED, _CoordinatesPass.targets, strict=True)
        )
