"""Surfaces behind air, and the air's own light: out = surfaces * transmittance + scattered."""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..gpu.raster import FullscreenPass
from ..gpu.slots import texture


class _Compose(FullscreenPass):
    slots = tuple(
        texture(name, "2d", "unfilterable-float")
        for name in ("direct", "indirect", "transmittance", "single", "multiple")
    )
    targets = ("rgba32float", "rgba32float", "rgba32float")
    file = "compose.wgsl"


class Compose:
    """The finished picture and its parts, W m^-2 sr^-1, as the eye sees them through the air.

    `radiance` is the sum of `direct`, `indirect` (both attenuated) and the two scattered layers.
    """

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        self.gpu, self._pass = gpu, _Compose(gpu)
        self._make_layers(size)

    def _make_layers(self, size: tuple[int, int]) -> None:
        self.direct, self.indirect, self.radiance = (
            Texture(self.gpu, f"composed {name}", size, "rgba32float", target=True)
            for name in ("direct", "indirect", "radiance")
        )

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with pictures of `size`, pixels."""
        self.release()
        self._make_layers(size)

    def encode(
        self, commands: Commands, *, direct: Texture, indirect: Texture, transmittance: Texture,
        single: Texture, multiple: Texture,
    ) -> None:  # fmt: skip
        """Fill the three layers."""
        self._pass.draw(
            commands, (self.direct, self.indirect, self.radiance), direct=direct,
            indirect=indirect, transmittance=transmittance, single=single, multiple=multiple,
        )  # fmt: skip

    def release(self) -> None:
        """Give the memory back."""
        for layer in (self.direct, self.indirect, self.radiance):
            layer.release()
