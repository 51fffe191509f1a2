"""What an image of media is asked for, and its textures: layers, reduced images for them.

single          shafts of lights, reduced as `shaft_rays`     -> shafts_alone
sky             the sky's single scattering, as `march_rays`  -> single_scatter, with shafts
multiple        marched fields                                -> multiple_scatter
transmittance   along marched rays, through density grids     -> transmittance
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..gpu.shared import Shared
from ..scene.medium import Medium
from ..scene.volume import Volume
from .rays import Rays


@dataclass(frozen=True)
class Expected:
    """What a `MediaImage` will be given to march: `sources` textures, a lattice, the sky's lattice.

    `solved`: volumes whose sources bring their single scattering, of local lights unless
    `has_local_shafts`; see `GpuMedia`. `shared`: where density grids are kept.
    """

    sources: int = 0
    has_lattice: bool = False
    has_sky: bool = False
    solved: Sequence[Medium | Volume] = ()
    has_local_shafts: bool = False
    shared: Shared | None = None


@dataclass(frozen=True)
class Drawn:
    """What an image is drawn of: shafts, marched fields, the sky's light, density grids."""

    has_shafts: bool
    is_marched: bool
    has_sky: bool
    has_grids: bool


class ImageTextures:
    """Textures of the size of `march_rays` and `shaft_rays`, which may be the same."""

    def __init__(self, gpu: Gpu, march_rays: Rays, shaft_rays: Rays, drawn: Drawn) -> None:
        self._gpu, self._drawn = gpu, drawn
        self.march_rays, self.shaft_rays = march_rays, shaft_rays
        self._make(march_rays.size)

    def _make(self, size: tuple[int, int]) -> None:
        def made(name: str, size: tuple[int, int]) -> Texture:
            return Texture(self._gpu, name, size, "rgba32float", target=True, written=True)

        drawn = self._drawn
        # The layers of the image.
        self.single_scatter = made("single scatter", size)
        self.multiple_scatter = made("multiple scatter", size)
        self.transmittance = made("transmittance", size)
        # Single scattering of lights; that of the sky is added to it.
        self.shafts_alone = self.single_scatter
        if drawn.has_sky:
            self.shafts_alone = made("shafts", size)
        # What is drawn along fewer rays; the sky's light always, as it is added to shafts.
        is_reduced = drawn.is_marched and self.march_rays.scale > 1
        wanted = {
            "single": drawn.has_shafts and self.shaft_rays.scale > 1,
            "multiple": is_reduced,
            "transmittance": is_reduced and drawn.has_grids,
            "sky": drawn.has_sky,
        }
        self.reduced = {
            name: made(f"reduced {name}", self.rays_of(name).reduced)
            for name, is_wanted in wanted.items()
            if is_wanted
        }

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with rays and textures of `size`, pixels."""
        # Both may be the same rays, which are resized once.
        for rays in {id(r): r for r in (self.march_rays, self.shaft_rays)}.values():
            rays.resize(size)
        alone = (self.shafts_alone,) if self._drawn.has_sky else ()
        layers = (self.single_scatter, self.multiple_scatter, self.transmittance, *alone)
        for texture in (*layers, *self.reduced.values()):
            texture.release()
        self._make(size)

    def full(self, name: str) -> Texture:
        """The full-size texture that becomes of a reduced one."""
        return {
            "single": self.shafts_alone,
            "multiple": self.multiple_scatter,
            "transmittance": self.transmittance,
        }[name]

    def target(self, name: str) -> Texture:
        """The target of a kernel: the reduced texture, or the full one where none is reduced."""
        return self.full(name) if self.rays_of(name).scale == 1 else self.reduced[name]

    def rays_of(self, name: str) -> Rays:
        """The rays along which a texture is drawn."""
        return self.shaft_rays if name == "single" else self.march_rays
