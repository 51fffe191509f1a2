"""Surfaces behind media: their radiance times the transmittance."""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.fullscreen import FullscreenPass
from ...gpu.memory import Texture
from ...gpu.slots import texture


class _Compose(FullscreenPass):
    slots = tuple(
        texture(name, "2d", "unfilterable-float")
        for name in ("direct", "indirect", "transmittance")
    )
    targets = ("rgba32float", "rgba32float")
    file = "compose.wgsl"


class Compose:
    """The layers of surfaces, W m^-2 sr^-1, as the eye sees them through media."""

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        self.gpu, self._pass = gpu, _Compose(gpu)
        self._make_layers(size)

    def _make_layers(self, size: tuple[int, int]) -> None:
        self.direct, self.indirect = (
            Texture(self.gpu, f"composed {name}", size, "rgba32float", target=True, written=True)
            for name in ("direct", "indirect")
        )

    @property
    def layers(self) -> tuple[Texture, Texture]:
        """Both, in the order of the pass's targets."""
        return (self.direct, self.indirect)

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with images of `size`, pixels."""
        for layer in self.layers:
            layer.release()
        self._make_layers(size)

    def encode(
        self, commands: Commands, *, direct: Texture, indirect: Texture, transmittance: Texture
    ) -> None:
        """Fill both layers."""
        self._pass.draw(
            commands, self.layers, direct=direct, indirect=indirect, transmittance=transmittance
        )
