"""Translucent surfaces in the image: layers, lit as solid surfaces are, one behind the other.

peel  G-buffer of a layer -> lit as any image, with the media before it -> under the layers so far
last  the image of what is solid -> under all layers

A layer adds its own light where it is there; the light that media scatter before it counts as far
as it covers what lies behind it, whose light comes through those media once more.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.memory import Texture
from ..gpu.slots import texture
from ..surface.geometry import GpuScene
from ..surface.peeled import PeeledGBuffer
from .read_layers import NOT_ADDED
from .view import View

SURFACE_LAYERS = ("direct", "indirect")
"""Layers of light that comes from surfaces; media scatter that of all others."""


class _Under(FullscreenPass):
    slots = tuple(
        texture(name, "2d", "unfilterable-float") for name in ("front", "passed", "taken", "light")
    )
    targets = ("rgba32float",)
    file = "under.wgsl"


class _Passed(FullscreenPass):
    slots = tuple(texture(name, "2d", "unfilterable-float") for name in ("passed", "taken"))
    targets = ("rgba16float",)
    file = "passed.wgsl"


class _Pair:
    """Two textures, of which one is read while the other is written."""

    def __init__(self, gpu: Gpu, label: str, size: tuple[int, int], format: str) -> None:
        self.read, self.write = (
            Texture(gpu, label, size, format, target=True, written=True) for _ in "ab"
        )

    def swap(self) -> None:
        """Read from now on what was written."""
        self.read, self.write = self.write, self.read


class Translucent:
    """The layers of one view. `view` is aimed at each layer in turn; draw it, then `add` it."""

    def __init__(self, gpu: Gpu, size: tuple[int, int], most: int) -> None:
        """`most` layers are drawn; surfaces behind them, before solid ones, are left out."""
        self.gpu, self._most, self._sized = gpu, most, gpu.scope()
        # By what they draw, compiled when an image first needs them.
        self._under_passes: dict[tuple[str, ...], _Under] = {}
        self._passed_passes: dict[bool, _Passed] = {}
        self._make(size)

    def _make(self, size: tuple[int, int]) -> None:
        self.view = View(self._sized, size, PeeledGBuffer)
        self._passed = _Pair(self._sized, "passed", size, "rgba16float")
        self._nothing = Texture(self._sized, "no layer", (1, 1), "rgba16float")
        self._fronts: dict[str, _Pair] = {}
        self._started: set[str] = set()  # of the fronts that hold something of this image
        self._is_passed = False  # whether any layer of this image was added

    def resize(self, size: tuple[int, int]) -> None:
        """Draw images of `size`, pixels, from here on."""
        self._sized.release()
        self._make(size)

    def layers(self, view: View, scene: GpuScene) -> Iterator[View]:
        """The views to draw before `view`, whose depth is drawn: one for each layer."""
        gbuffer = self.view.gbuffer
        assert isinstance(gbuffer, PeeledGBuffer)
        # No pixel has more layers than there are translucent triangles.
        draws = scene.translucent(view.clip_from_world)
        triangles = sum(draw.index_count * draw.instance_count for draw in draws) // 3
        # Nothing of this image is there yet.
        self._started, self._is_passed = set(), False
        self.view.follow(view)
        gbuffer.begin(view.gbuffer.depth, view.eye)
        for _ in range(min(self._most, triangles)):
            yield self.view

    def add(self, commands: Commands, images: Mapping[str, Texture]) -> None:
        """Put the layer that was drawn, whose `images` these are, under those before it."""
        gbuffer = self.view.gbuffer
        assert isinstance(gbuffer, PeeledGBuffer)
        # By kind: light of surfaces, or of the medium before them, each attenuated by the layers
        # in front.
        for name, image in images.items():
            if name in NOT_ADDED:
                continue
            kind = "IS_SURFACE" if name in SURFACE_LAYERS else "IS_MEDIUM"
            self._under(commands, name, kind, image, gbuffer.taken)
        # The transmittance of all layers so far attenuates the next one behind.
        if self._is_passed not in self._passed_passes:
            constants = {"HAS_PASSED": float(self._is_passed)}
            self._passed_passes[self._is_passed] = _Passed(self.gpu, constants=constants)
        self._passed_passes[self._is_passed].draw(
            commands, (self._passed.write,), passed=self._passed.read, taken=gbuffer.taken
        )
        self._passed.swap()
        self._is_passed = True

    def finish(self, commands: Commands, images: Mapping[str, Texture]) -> dict[str, Texture]:
        """The `images` of what is solid, as they are seen through all layers."""
        # Without any layer the image is what is solid.
        if not self._is_passed:
            return dict(images)
        for name, image in images.items():
            self._under(commands, name, "IS_LAST", image, self._nothing)
        return {name: self._fronts[name].read for name in images}

    def _under(
        self, commands: Commands, name: str, kind: str, image: Texture, taken: Texture
    ) -> None:
        """Put the layer `name` of an image under what is there of it so far."""
        if name not in self._fronts:
            self._fronts[name] = _Pair(
                self._sized, f"{name} in front", self.view.size, "rgba32float"
            )
        # The variant of the pass: what there is in front of the layer.
        front, key = self._fronts[name], [kind]
        if name in self._started:
            key.append("HAS_FRONT")
        if self._is_passed:
            key.append("HAS_PASSED")
        made = self._under_passes.get(tuple(key))
        if made is None:
            made = _Under(self.gpu, constants=dict.fromkeys(key, 1.0))
            self._under_passes[tuple(key)] = made
        # C = C_front + T_front L: the layer is attenuated by what lies before it.
        made.draw(
            commands,
            (front.write,),
            front=front.read,
            passed=self._passed.read,
            taken=taken,
            light=image,
        )
        front.swap()
        self._started.add(name)
