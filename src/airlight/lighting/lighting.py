"""The pass that lights surfaces: lights with shadows, emission, sky, lattices, background.

The material is Lambert plus GGX (Walter2007) with Smith's height-correlated shadowing (Heitz2014)
and Schlick's Fresnel term, as glTF 2.0 defines it.
"""

from __future__ import annotations

from functools import partial

from ..gpu.demands import fits
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.memory import Texture
from ..surface.hits import PIXELS, Points
from .kernel import Emitters, Kernel, LatticeLight, lattices_kernel, lights_kernel
from .slots import Attenuation, Gloss, Part, lighting_slots


class Lighting(FullscreenPass):
    """G-buffer -> direct and indirect radiance, W m^-2 sr^-1."""

    targets = ("rgba32float", "rgba32float")

    def __init__(
        self,
        gpu: Gpu,
        part: Part,
        emitters: Emitters,
        lattices: LatticeLight,
        *,
        gloss: Gloss = "none",
        attenuation: Attenuation | None = None,
        points: Points = PIXELS,
    ) -> None:
        """`part`: which light is added up. `attenuation`: the media between lights and surfaces.

        `points`: whether surfaces are those of pixels, or hits of rays.
        """
        # Rays look for shadows where the device binds so much.
        slots_of = partial(
            lighting_slots, part, attenuation, gloss, points, has_panes=emitters.has_panes
        )
        shadows = emitters.shadows
        slots = slots_of(is_traced=shadows is not None)
        if shadows is not None and not fits(gpu, slots):
            shadows, slots = None, slots_of()
        self.slots = slots
        self.names = [slot.name for slot in self.slots]
        traced = shadows.constants(points) if shadows else None
        surfaces = {
            "HAS_SURFACES": float(emitters.has_surfaces),
        }
        # What is added up: lattices' light, lights', or both.
        kernel = (
            Kernel(points.wgsl, surfaces, {})
            + lattices_kernel(part, lattices, gloss)
            + lights_kernel(part, emitters, attenuation, traced)
        )
        super().__init__(
            gpu,
            generated=kernel.generated,
            constants=kernel.constants,
            firsts=kernel.firsts,
            targets=self.targets[:1] if part == "lights" else None,
        )


class RadianceLayers:
    """The targets of lighting: direct (with emission, sky, background; a = 1), indirect.

    `lit` is the direct layer without the sky, which exists where near surfaces light each other;
    `also` the light of a second field, which exists where hits have one.
    """

    def __init__(self, gpu: Gpu, size: tuple[int, int]) -> None:
        self.direct = Texture(gpu, "direct", size, "rgba32float", target=True, written=True)
        self.indirect = Texture(gpu, "indirect", size, "rgba32float", target=True, written=True)
        # Layers that few images ask for are made for the first that does.
        self._gpu, self._size = gpu, size
        self._lit: Texture | None = None
        self._also: Texture | None = None

    @property
    def targets(self) -> tuple[Texture, Texture]:
        """In the order of the pass's targets."""
        return (self.direct, self.indirect)

    @property
    def lit(self) -> Texture:
        """Radiance of surfaces by lights and emission, and the background."""
        if self._lit is None:
            self._lit = self._another("lit")
        return self._lit

    @property
    def also(self) -> Texture:
        """Radiance of surfaces by a second field."""
        if self._also is None:
            self._also = self._another("light of another field")
        return self._also

    def _another(self, name: str) -> Texture:
        return Texture(self._gpu, name, self._size, "rgba32float", target=True, written=True)
