"""Single scattering with texel-sharp volumetric shadows: lit intervals of eye rays.

An eye ray is a straight line over each shadow map. A hierarchy of the nearest and farthest depths
lets it cross wholly lit or dark squares at once, as a 2D digital differential analyser that
descends and ascends; adjacent lit stretches are one run, integrated in closed form (parallel
light) or with equi-angular Gauss-Legendre nodes (lamps). In density grids runs are cut into steps
of at least a voxel, each integrated as if the air in it were even.
Source: the hierarchy after Chen et al. 2011. differs: Billeter2012 section 3
renders the light volumes of Billeter et al. 2010, whose integral along the ray is the same.
"""

from __future__ import annotations

from typing import Any

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.layout import Struct, u32
from ...gpu.memory import Texture
from ...gpu.raster import FullscreenPass
from ...gpu.slots import Slot, image, storage, texture, uniform
from ...lighting.lights import Lights
from ...surface.light_table import LightData
from ...surface.light_views import LightViewData
from ..gpu_media import GpuMedia
from ..pixel_list import PixelList, RedrawParams, pixel_list_slots
from ..rays import RayParams, Rays
from .bounds import DepthBounds

SITE_CONTRAST = 0.3
"""Of the contrast that texels of the reduced picture may have, what those that others are made of
may have: these are farther apart."""
SITE_SPACING = 2
"""Texels of the reduced picture from one of these, a site, to the next in its row."""


class ShaftParams(Struct):
    """The sizes of the lights' maps, and how long a ray may take."""

    max_nodes = u32("squares opened or crossed before coarse ones are taken as they are")
    parallel_resolution = u32("texels")
    parallel_side = u32("texels, a power of two")
    parallel_top = u32("level a ray starts at")
    local_resolution = u32("texels")
    local_side = u32("texels, a power of two")
    local_top = u32("level a ray starts at")


def _slots(air: GpuMedia, *more: Slot) -> tuple[Slot, ...]:
    """Of passes that use wgsl/shaft_rays.wgsl."""
    return (
        uniform("rays", RayParams),
        uniform("shafts", ShaftParams),
        *air.slots,
        storage("lights", LightData),
        storage("parallel_views", LightViewData),
        storage("local_views", LightViewData),
        storage("parallel_bounds", "u32"),
        storage("local_bounds", "u32"),
        *more,
        image("scattered", "rgba32float"),
    )


def lit_interval_wgsl(air: GpuMedia, lights: Lights, steps: int = 32) -> str:
    """How lit intervals are integrated, and what is known beforehand: which media and lights."""
    use = "//! use lit_interval\n"
    if air.has_grids:
        use = f"const GRID_STEPS = {steps}.0;\n//! use lit_interval_grids\n"
    known = {
        "IS_ONE_BOX": air.is_one_box,
        "HAS_DIRECTIONAL": lights.parallel.layers > 0,
        "HAS_LOCAL": lights.local.layers > 0,
    }
    wgsl = air.wgsl + f"const LIGHT_COUNT = {lights.count}u;\n"
    return wgsl + "".join(f"const {k} = {str(v).lower()};\n" for k, v in known.items()) + use


class _Shafts(ComputePass):
    workgroup = (8, 8, 1)
    file = "shafts.wgsl"

    def __init__(self, gpu: Gpu, air: GpuMedia, lights: Lights, steps: int) -> None:
        self.slots = _slots(air, texture("picked", "2d", "unfilterable-float"))  # type: ignore[misc]
        super().__init__(gpu, generated=lit_interval_wgsl(air, lights, steps))


class _RefineFind(FullscreenPass):
    slots = (
        uniform("rays", RayParams),
        texture("depth", "2d", "depth"),
        texture("reduced", "2d", "unfilterable-float"),
        *pixel_list_slots(),
    )
    targets = ("rgba32float",)
    file = "find_pixels.wgsl"


class _Refine(ComputePass):
    workgroup = (64, 1, 1)
    file = "redraw_pixels.wgsl"

    def __init__(self, gpu: Gpu, air: GpuMedia, lights: Lights, steps: int) -> None:
        self.slots = _slots(  # type: ignore[misc]
            air,
            storage("found", "u32"),
            storage("chosen", "vec4u"),
            texture("depth", "2d", "depth"),
        )
        super().__init__(gpu, generated=lit_interval_wgsl(air, lights, steps))


class _Sites(_Shafts):
    file = "sparse_samples.wgsl"


class _Between(ComputePass):
    slots = (
        uniform("rays", RayParams),
        texture("picked", "2d", "unfilterable-float"),
        texture("sites", "2d", "unfilterable-float"),
        *pixel_list_slots(),
        image("scattered", "rgba32float"),
    )
    workgroup = (8, 8, 1)
    file = "sparse_interpolate.wgsl"


class _Differing(ComputePass):
    workgroup = (64, 1, 1)
    file = "redraw_texels.wgsl"

    def __init__(self, gpu: Gpu, air: GpuMedia, lights: Lights, steps: int) -> None:
        self.slots = _slots(  # type: ignore[misc]
            air,
            storage("found", "u32"),
            storage("chosen", "vec4u"),
            texture("picked", "2d", "unfilterable-float"),
        )
        super().__init__(gpu, generated=lit_interval_wgsl(air, lights, steps))


class _Sparse:
    """A reduced picture from one texel in four: between those that are alike others are means."""

    def __init__(
        self, gpu: Gpu, air: GpuMedia, lights: Lights, steps: int, reduced: tuple[int, int]
    ) -> None:
        self.gpu = gpu
        self._pass = _Sites(gpu, air, lights, steps)
        self._between, self._differing = _Between(gpu), _Differing(gpu, air, lights, steps)
        self.listed = PixelList(gpu, reduced)
        self._make(reduced)

    def _make(self, reduced: tuple[int, int]) -> None:
        self.size = ((reduced[0] + 1) // 2, (reduced[1] + 1) // 2)
        self.sites = Texture(self.gpu, "shafts at sites", self.size, "rgba32float", written=True)

    def resize(self, reduced: tuple[int, int]) -> None:
        self.sites.release()
        self.listed.resize(reduced)
        self._make(reduced)

    def encode(
        self,
        commands: Commands,
        rays: Rays,
        scattered: Texture,
        contrast: float,
        bound: dict[str, Any],
    ) -> None:
        """`bound`: what all passes along rays bind."""
        self._pass.dispatch(commands, self.size, scattered=self.sites, picked=rays.picked, **bound)
        self.listed.begin(commands)
        self._between.dispatch(
            commands,
            rays.reduced,
            rays=bound["rays"],
            picked=rays.picked,
            sites=self.sites,
            redrawn=RedrawParams.of(contrast=contrast, group=self._differing.workgroup[0]),
            scattered=scattered,
            **self.listed.bound,
        )
        self._differing.dispatch_indirect(
            commands,
            self.listed.groups,
            found=self.listed.found,
            chosen=self.listed.chosen,
            picked=rays.picked,
            scattered=scattered,
            **bound,
        )


class Shafts:
    """The scheme `minmax`, for any air."""

    def __init__(
        self,
        gpu: Gpu,
        air: GpuMedia,
        lights: Lights,
        rays: Rays,
        *,
        max_nodes: int = 256,
        steps: int = 32,
    ) -> None:
        """`rays` as `encode` will get them; `steps` of a ray where there are density grids."""
        self.gpu, self.air, self.max_nodes = gpu, air, max_nodes
        self.parallel = DepthBounds(gpu, lights.parallel)
        self.local = DepthBounds(gpu, lights.local)
        self._pass = _Shafts(gpu, air, lights, steps)
        self._find, self._refine = _RefineFind(gpu), _Refine(gpu, air, lights, steps)
        self.listed = PixelList(gpu, rays.size)
        self._steps = steps
        self._sparse: _Sparse | None = None  # made when it is first asked for

    def resize(self, rays: Rays) -> None:
        """Go on with pictures of the size of `rays`."""
        self.listed.resize(rays.size)
        if self._sparse:
            self._sparse.resize(rays.reduced)

    def prepare(self, commands: Commands) -> None:
        """Bring the hierarchies up to date, where shadow maps changed."""
        self.parallel.encode(commands)
        self.local.encode(commands)

    def encode(
        self,
        commands: Commands,
        params: RayParams,
        rays: Rays,
        lights: Lights,
        scattered: Texture,
        contrast: float = 0.0,
    ) -> None:
        """Fill `scattered`, of the size of `rays.reduced`: radiance, W m^-2 sr^-1; as its alpha
        how far rays go, m.

        `contrast` that a reduced picture's texels may have (`redrawn`); between neighbours that
        differ by less than SITE_CONTRAST of it, one texel in four, the others are means. 0: none
        are, for shafts may fit between those.
        """
        if rays.scale > 1 and 0.0 < contrast < 1.0:
            if self._sparse is None:
                self._sparse = _Sparse(self.gpu, self.air, lights, self._steps, rays.reduced)
            self._sparse.encode(
                commands,
                rays,
                scattered,
                SITE_CONTRAST * contrast,
                {"rays": params, **self._bound(lights)},
            )
            return
        self._pass.dispatch(
            commands,
            rays.reduced,
            rays=params,
            picked=rays.picked,
            **self._bound(lights),
            scattered=scattered,
        )

    def refine(
        self,
        commands: Commands,
        params: RayParams,
        lights: Lights,
        depth: Texture,
        reduced: Texture,
        scattered: Texture,
        contrast: float,
    ) -> None:
        """Fill the full-size `scattered` from `reduced`, as `encode` filled it.

        Beside a lamp and at the edges of shafts a reduced picture cannot be interpolated: where
        texels of a pixel's depth differ, or none has it, the pixel is drawn anew.
        """
        self.listed.begin(commands)
        self._find.draw(
            commands,
            (scattered,),
            rays=params,
            depth=depth,
            reduced=reduced,
            redrawn=self.redrawn(contrast),
            **self.listed.bound,
        )
        self.redraw(commands, params, lights, depth, scattered)

    def redrawn(self, contrast: float) -> RedrawParams:
        """For the pass that lists the pixels that `redraw` takes."""
        return RedrawParams.of(contrast=contrast, group=self._refine.workgroup[0])

    def redraw(
        self,
        commands: Commands,
        params: RayParams,
        lights: Lights,
        depth: Texture,
        scattered: Texture,
    ) -> None:
        """Draw the pixels of the full-size `scattered` anew that are `listed`."""
        listed = self.listed
        self._refine.dispatch_indirect(
            commands,
            listed.groups,
            rays=params,
            found=listed.found,
            chosen=listed.chosen,
            depth=depth,
            **self._bound(lights),
            scattered=scattered,
        )

    def _bound(self, lights: Lights) -> dict[str, Any]:
        """What both passes bind."""
        shafts = ShaftParams(
            max_nodes=self.max_nodes,
            parallel_resolution=self.parallel.maps.depth.size[0],
            parallel_side=self.parallel.side,
            parallel_top=self.parallel.top,
            local_resolution=self.local.maps.depth.size[0],
            local_side=self.local.side,
            local_top=self.local.top,
        )
        return {
            "shafts": shafts,
            **self.air.bound,
            "lights": lights.table,
            "parallel_views": lights.parallel.views,
            "local_views": lights.local.views,
            "parallel_bounds": self.parallel.buffer,
            "local_bounds": self.local.buffer,
        }
