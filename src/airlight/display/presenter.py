"""A renderer's layers to a surface: combine, meter, tone map, show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.view import View
from .combine import DEPTH, NORMAL, RADIANCE, RAW, Combine
from .meter import Meter
from .show import Place, Show
from .tone import Tone

IMAGE = "image"
# Layers that are no radiance, and how their values are shown.
_RAW_LAYERS = {"transmittance": RAW, "albedo": RAW, "normal": NORMAL, "depth": DEPTH}


@dataclass(frozen=True)
class Look:
    """Which layer is shown, and its exposure.

    `layer`: "image" (the sum), a radiance layer, transmittance, albedo, normal or depth.
    `exposure_stops` None: from the image itself. `reach_m`: the distance that the depth view shows
    half bright; nearer is brighter.
    """

    layer: str = IMAGE
    exposure_stops: float | None = 0.0
    curve: str = "agx"
    reach_m: float = 1.0


def layer_names(images: dict[str, Texture]) -> tuple[str, ...]:
    """The layers that a view of a technique with these `images` can show."""
    # Radiance layers add up to the image; the raw ones are shown alone.
    radiance = [name for name in images if name not in _RAW_LAYERS]
    raw = [name for name in images if name in _RAW_LAYERS]
    return (IMAGE, *radiance, *raw, "albedo", "normal", "depth")


class Presenter:
    """Images of one size at a time, onto surfaces of one format and any size."""

    def __init__(self, gpu: Gpu, size: tuple[int, int], format: str) -> None:
        # A scope of its own, so that all memory goes back at once.
        self.size, self.gpu = size, gpu.scope()
        # In the order in which an image goes through them.
        self._combine, self._meter = Combine(self.gpu, size), Meter(self.gpu)
        self._tone, self._show = Tone(self.gpu, size), Show(self.gpu, format)
        self._is_metered_before = False

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on; the mean is lost."""
        # A mean of images of another size is worth nothing.
        if size != self.size:
            self.size = size
            self._combine.resize(size)
            self._tone.resize(size)

    def take(
        self, commands: Commands, images: dict[str, Texture], view: View, look: Look, index: int
    ) -> None:
        """Add sample number `index` of a drawn view to the mean; 0 restarts it."""
        # Layers of radiance add up to the image; raw ones are shown as they are.
        kind = _RAW_LAYERS.get(look.layer, RADIANCE)
        with commands.stage("combine"):
            self._combine.encode(
                commands,
                _chosen(images, view, look.layer),
                view.gbuffer.depth,
                index,
                kind=kind,
                depth_at_reach=view.near_m / look.reach_m,
            )

    def tone(
        self,
        commands: Commands,
        look: Look,
        *,
        settled: bool = True,
        exposed_as: Presenter | None = None,
    ) -> None:
        """Tone map the mean; the metered exposure follows slowly unless `settled`.

        `exposed_as`: what was metered of another presenter's image, to be compared with.
        """
        # Exposure follows the image, over some frames while it changes; raw layers have none.
        meter = exposed_as._meter if exposed_as else self._meter
        is_raw, is_metered = look.layer in _RAW_LAYERS, look.exposure_stops is None
        with commands.stage("tone"):
            if is_metered and not is_raw and exposed_as is None:
                # The first image sets the exposure at once.
                speed = 1.0 if settled or not self._is_metered_before else 0.3
                self._meter.encode(commands, self._combine.image, speed)
                self._is_metered_before = True
            self._tone.encode(
                commands,
                self._combine.image,
                meter.stops,
                is_metered=is_metered,
                exposure_stops=look.exposure_stops or 0.0,
                curve=look.curve,
                is_raw=is_raw,
            )

    def show(
        self,
        commands: Commands,
        view: Any,
        place: Place | None = None,
        compared: tuple[Presenter, float] | None = None,
    ) -> None:
        """Draw the tone-mapped image onto a place of the surface's texture `view`.

        Without a `place` the image fills it. `compared`: another presenter, and the share of the
        width right of which its image is seen.
        """
        place = place or Place((0.0, 0.0), tuple(view.size[:2]))
        other = (compared[0]._tone.shown, compared[1]) if compared else None
        self._show.draw(commands, view, place, self._tone.shown, other)

    def release(self) -> None:
        """Give the memory back."""
        self.gpu.release()


def _chosen(images: dict[str, Texture], view: View, layer: str) -> list[Texture]:
    """The textures whose sum is shown; the image where a technique has no such layer."""
    g = view.gbuffer
    own = {"albedo": g.albedo, "normal": g.normal}
    if layer == "depth":
        return []
    if layer in own or layer in images:
        return [own.get(layer) or images[layer]]
    return [texture for name, texture in images.items() if name not in _RAW_LAYERS]
