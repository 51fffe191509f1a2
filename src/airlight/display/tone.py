"""Exposure, tone curve, sRGB and dither on the device: the twin of `maths.tone.display_srgb8`."""

from __future__ import annotations

from ..errors import SettingsError, nearest
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.layout import Struct, f32, u32
from ..gpu.memory import Buffer, Texture
from ..gpu.slots import storage, texture, uniform
from ..maths.tone import TONE_CURVES


class ToneParams(Struct):
    """How radiance becomes 8 bits."""

    exposure = f32("stops, added to the metered ones")
    is_metered = u32("whether the metered exposure counts")
    curve = u32("its place in maths.tone.TONE_CURVES")
    is_raw = u32("1: values in [0, 1] are encoded as they are")


class _Tone(FullscreenPass):
    slots = (
        uniform("params", ToneParams),
        texture("image", "2d", "unfilterable-float"),
        storage("metered", "f32"),
    )
    targets = ("rgba8unorm",)
    file = "tone.wgsl"


class Tone:
    """`shown` is the image as a display takes it: rgba8unorm, sRGB-encoded."""

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        self.gpu, self._pass = gpu, _Tone(gpu)
        self.shown = Texture(gpu, "shown", size, "rgba8unorm", target=True, written=True)

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on."""
        self.shown.release()
        self.shown = Texture(self.gpu, "shown", size, "rgba8unorm", target=True, written=True)

    def encode(
        self,
        commands: Commands,
        image: Texture,
        metered: Buffer,
        *,
        exposure_stops: float = 0.0,
        is_metered: bool = False,
        curve: str = "agx",
        is_raw: bool = False,
    ) -> None:
        """Fill `shown`. Raises SettingsError for an unknown curve."""
        if curve not in TONE_CURVES:
            raise SettingsError(f"unknown tone curve '{curve}'", remedy=nearest(curve, TONE_CURVES))

        # The shader knows curves by their place in the table.
        params = ToneParams(
            exposure=exposure_stops,
            is_metered=int(is_metered),
            curve=list(TONE_CURVES).index(curve),
            is_raw=int(is_raw),
        )
        self._pass.draw(commands, (self.shown,), params=params, image=image, metered=metered)
