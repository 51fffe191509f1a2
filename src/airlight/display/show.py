"""A tone-mapped image on a part of a surface, encoded as the surface's format needs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.layout import Struct, f32, vec2f
from ..gpu.memory import Texture, linear_sampler
from ..gpu.slots import sampler, texture, uniform


@dataclass(frozen=True)
class Place:
    """Where on a surface an image is: its upper left corner and its extent, pixels."""

    corner: tuple[float, float]
    extent: tuple[float, float]


class ShowParams(Struct):
    """Where the images are."""

    corner = vec2f("of the images, pixels")
    extent = vec2f("of the images, pixels")
    split = f32("the share of the width from which on the other image is shown; 1 or more: none")


class _Show(FullscreenPass):
    slots = (
        uniform("params", ShowParams),
        texture("shown", "2d", "float"),
        texture("compared", "2d", "float"),
        sampler("linear_clamp"),
    )
    file = "show.wgsl"


class Show:
    """Draws onto views of textures of one `format`; one that ends in -srgb encodes by itself."""

    def __init__(self, gpu: Gpu, format: str) -> None:
        # A format that encodes by itself takes linear values from the shader.
        self._pass = _Show(
            gpu, targets=(format,), constants={"is_encoding": float(format.endswith("-srgb"))}
        )
        self._linear = linear_sampler(gpu, "show")

    def draw(
        self,
        commands: Commands,
        view: Any,
        place: Place,
        shown: Texture,
        compared: tuple[Texture, float] | None = None,
    ) -> None:
        """Put `shown`, sRGB-encoded, onto a `place` of `view`; dark grey is beside it.

        `compared`: another such image, and the share of the width from which on it is seen.
        """
        # Without another image the split lies beyond the right edge.
        other, split = compared or (shown, 2.0)
        params = ShowParams(corner=place.corner, extent=place.extent, split=split)
        self._pass.draw(
            commands, (view,), params=params, shown=shown, compared=other, linear_clamp=self._linear
        )
