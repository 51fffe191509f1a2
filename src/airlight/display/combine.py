"""One image from a technique's layers (their sum, one of them, a debug view), averaged."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import SettingsError
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.layout import Struct, f32, u32, vec4f
from ..gpu.memory import Texture
from ..gpu.slots import texture, uniform

MOST_LAYERS = 4
# How layers become one image: radiance adds up, the others are shown as they are.
RADIANCE, RAW, NORMAL, DEPTH = range(4)
_SLOTS = tuple(f"layer{i}" for i in range(MOST_LAYERS))


class CombineParams(Struct):
    """The view that is shown, and the new image's weight in the mean."""

    weights = vec4f("of the layers")
    weight = f32("of the new image; 1 restarts")
    kind = u32("0 radiance, 1 raw, 2 normal, 3 depth")
    depth_at_reach = f32("the depth that is shown half as bright")


class _Combine(FullscreenPass):
    slots = (
        uniform("params", CombineParams),
        *(texture(name, "2d", "unfilterable-float") for name in _SLOTS),
        texture("depth", "2d", "depth"),
        texture("mean", "2d", "unfilterable-float"),
    )
    targets = ("rgba32float",)
    file = "combine.wgsl"


class Combine:
    """The mean so far is `image`: radiance W m^-2 sr^-1, or a debug view's values in [0, 1]."""

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        self.gpu, self._pass = gpu, _Combine(gpu)
        self._make_means(size)

    def _make_means(self, size: tuple[int, int]) -> None:
        # Two, because a pass cannot read the texture that it draws into.
        self._means = [
            Texture(self.gpu, f"mean {i}", size, "rgba32float", target=True, written=True)
            for i in range(2)
        ]

    @property
    def image(self) -> Texture:
        """The mean of all images since index 0."""
        return self._means[0]

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on; the mean is lost."""
        for mean in self._means:
            mean.release()
        self._make_means(size)

    def encode(
        self,
        commands: Commands,
        layers: Sequence[Texture],
        depth: Texture,
        index: int,
        *,
        kind: int = RADIANCE,
        depth_at_reach: float = 1.0,
    ) -> None:
        """Add the sum of `layers` to the mean as image number `index`; 0 restarts it.

        `depth_at_reach`: the depth that the depth view shows half bright.
        Raises SettingsError for more than MOST_LAYERS layers.
        """
        if len(layers) > MOST_LAYERS:
            raise SettingsError(f"{len(layers)} layers cannot be shown at once")
        # Slots without a layer get one of weight 0.
        filled = [*layers, *[self._means[0]] * (MOST_LAYERS - len(layers))]
        # The running mean m += (x - m) / (k + 1), from one texture into the other.
        params = CombineParams(
            weights=[float(i < len(layers)) for i in range(MOST_LAYERS)],
            weight=1.0 / (index + 1),
            kind=kind,
            depth_at_reach=depth_at_reach,
        )
        self._pass.draw(
            commands,
            (self._means[1],),
            params=params,
            depth=depth,
            mean=self._means[0],
            **dict(zip(_SLOTS, filled, strict=True)),
        )
        self._means.reverse()
