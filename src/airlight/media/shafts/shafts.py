"""Single scattering with texel-sharp volumetric shadows: lit intervals of eye rays.

An eye ray is a straight line over each shadow map. By a hierarchy of the nearest and farthest
depths it crosses wholly lit or dark squares at once, as a 2D digital differential analyser that
descends and ascends. Adjacent lit stretches are one interval, which is integrated in closed form
(parallel light) or with equi-angular Gauss-Legendre nodes (local lights). In density grids
intervals are cut into steps of at least a voxel, in each of which the medium counts as homogeneous.
Source: the hierarchy after Chen2011. differs: Billeter2012 section 3 renders the light
volumes of Billeter2010, whose integral along the ray is the same.
"""

from __future__ import annotations

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.fullscreen import FullscreenPass
from ...gpu.memory import Texture
from ...gpu.slots import storage, texture, uniform
from ...lighting.lights import Lights
from ..pixel_list import PixelList, RedrawParams, pixel_list_slots
from ..rays import RayParams, Rays
from .shadow_rays import ShadowRays


class _Shafts(ComputePass):
    workgroup = (8, 8, 1)
    file = "shafts.wgsl"

    def __init__(self, shadows: ShadowRays) -> None:
        self.slots = shadows.slots(texture("picked", "2d", "unfilterable-float"))
        super().__init__(shadows.gpu, generated=shadows.wgsl)


class _FindPixels(FullscreenPass):
    slots = (
        uniform("rays", RayParams),
        texture("depth", "2d", "depth"),
        texture("reduced", "2d", "unfilterable-float"),
        *pixel_list_slots(),
    )
    targets = ("rgba32float",)
    file = "find_pixels.wgsl"


class _RedrawPixels(ComputePass):
    workgroup = (64, 1, 1)
    file = "redraw_pixels.wgsl"

    def __init__(self, shadows: ShadowRays) -> None:
        self.slots = shadows.slots(
            storage("found", "u32"),
            storage("chosen", "vec4u"),
            texture("depth", "2d", "depth"),
        )
        super().__init__(shadows.gpu, generated=shadows.wgsl)


class Shafts:
    """The scheme `minmax`, for any media."""

    def __init__(self, shadows: ShadowRays, rays: Rays) -> None:
        """Along `rays`, full-size or reduced."""
        self._shadows, self._rays = shadows, rays
        self._pass = _Shafts(shadows)
        self._find, self._redraw = _FindPixels(shadows.gpu), _RedrawPixels(shadows)
        self.listed = PixelList(shadows.gpu, rays.size)

    def resize(self) -> None:
        """Go on with images of the size of the rays."""
        self.listed.resize(self._rays.size)

    def prepare(self, commands: Commands) -> None:
        """Compute the hierarchies, after shadow maps changed."""
        self._shadows.encode(commands)

    def encode(
        self,
        commands: Commands,
        lights: Lights,
        scattered: Texture,
    ) -> None:
        """Fill `scattered`, of the size of `Rays.reduced`: radiance, W m^-2 sr^-1; alpha: m."""
        rays = self._rays
        bound = self._shadows.bound(rays, lights)
        self._pass.dispatch(
            commands, rays.reduced, picked=rays.picked, **bound, scattered=scattered
        )

    def refine(
        self,
        commands: Commands,
        lights: Lights,
        depth: Texture,
        reduced: Texture,
        scattered: Texture,
        contrast: float,
    ) -> None:
        """Fill the full-size `scattered` from `reduced`, as `encode` filled it.

        Beside a local light and at the edges of shafts a reduced image cannot be interpolated:
        where texels of a pixel's depth differ, or none has it, the pixel is redrawn.
        """
        # Interpolated where texels are alike; the others listed, and drawn pixel by pixel.
        self.listed.begin(commands)
        self._find.draw(
            commands,
            (scattered,),
            rays=self._rays.params,
            depth=depth,
            reduced=reduced,
            redrawn=self.redrawn(contrast),
            **self.listed.bound,
        )
        self.redraw(commands, lights, depth, scattered)

    def redrawn(self, contrast: float) -> RedrawParams:
        """Parameters of a pass that lists the pixels for `redraw`."""
        return RedrawParams.of(contrast=contrast, group=self._redraw.workgroup[0])

    def redraw(
        self, commands: Commands, lights: Lights, depth: Texture, scattered: Texture
    ) -> None:
        """Redraw the pixels of the full-size `scattered` that are `listed`."""
        # The device alone knows how many pixels it listed.
        self._redraw.dispatch_indirect(
            commands,
            self.listed.groups,
            found=self.listed.found,
            chosen=self.listed.chosen,
            depth=depth,
            **self._shadows.bound(self._rays, lights),
            scattered=scattered,
        )
