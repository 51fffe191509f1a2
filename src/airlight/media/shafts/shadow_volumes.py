"""Single scattering by shadow volumes, which are rasterised face by face.

F(t), the radiance at the eye from the first t metres of its ray without shadows, has a closed form.
The boundary of what each shadow map shadows is drawn as triangles. The radiance is F(surface), plus
F where the ray enters a shadow and minus F where it leaves one, summed in a 32-bit float target.
F(0) = 0, so nothing behind the eye needs a cap; F stops at the visible surface, so nothing is
tested against its depth. Source: Billeter2010; the scheme of Billeter2012 section 3. differs: the
closed forms are those of `lit_interval`, without tables; shadow volumes are rasterised instead of
lit ones, so that the borders of a map need no lids.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ...errors import SettingsError
from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu
from ...gpu.fullscreen import FullscreenPass
from ...gpu.layout import Struct, mat4x4f, u32
from ...gpu.memory import Texture
from ...gpu.raster import RasterPipeline
from ...gpu.rows import table
from ...gpu.slots import image, storage, texture, uniform
from ...lighting.lights import Lights
from ...maths.transforms import F64
from ...surface.light_table import LightData
from ...surface.light_views import LightViewData
from ..gpu_media import GpuMedia
from ..rays import RayParams, Rays
from .facets import TREE_SLOTS, Draw, FacetTrees
from .shadow_rays import lit_interval_wgsl

# Light before faces and behind them is added with a sign, in full floats.
FEATURE = "float32-blendable"
_ADDED = {"src_factor": "one", "dst_factor": "one", "operation": "add"}


class LitParams(Struct):
    """How many lights there are."""

    light_count = u32()


class VolumeParams(Struct):
    """The map whose shadow volumes are drawn."""

    clip_from_eye = mat4x4f("from metres, with the eye as origin")
    is_parallel = u32()
    light_count = u32()


class _Lit(FullscreenPass):
    targets = ("rgba32float",)
    file = "shadow_volumes_lit.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia, lights: Lights) -> None:
        self.slots = (
            uniform("rays", RayParams),
            uniform("params", LitParams),
            *media.slots,
            table("lights", LightData),
            texture("picked", "2d", "unfilterable-float"),
        )
        super().__init__(gpu, generated=lit_interval_wgsl(media, lights))


class _Dark(RasterPipeline):
    targets = ("rgba32float",)
    blend: ClassVar[dict[str, Any]] = {"color": _ADDED, "alpha": _ADDED}
    file = "shadow_volumes.wgsl"

    def __init__(self, gpu: Gpu, media: GpuMedia, lights: Lights) -> None:
        self.slots = (
            uniform("rays", RayParams),
            uniform("params", VolumeParams),
            *TREE_SLOTS,
            *media.slots,
            table("lights", LightData),
            table("views", LightViewData),
            storage("facets", "vec4f"),
            storage("triangles", "u32"),
            texture("picked", "2d", "unfilterable-float"),
        )
        super().__init__(gpu, generated=lit_interval_wgsl(media, lights))


class _Clamp(ComputePass):
    slots = (texture("summed", "2d", "unfilterable-float"), image("scattered", "rgba32float"))
    file = "shadow_volumes_clamp.wgsl"


class Volumes:
    """The scheme `volumes`, for one homogeneous box."""

    def __init__(
        self,
        gpu: Gpu,
        media: GpuMedia,
        lights: Lights,
        rays: Rays,
        *,
        tolerance: float = 0.5,
    ) -> None:
        """Raises SettingsError where the media or the device do not allow it."""
        _check(gpu, media)
        self.media, self.rays = media, rays
        # Facets of all shadow maps.
        self.parallel = FacetTrees(gpu, lights.parallel, tolerance)
        self.local = FacetTrees(gpu, lights.local, tolerance)
        self._clamp = _Clamp(gpu)
        self._lit, self._dark = _Lit(gpu, media, lights), _Dark(gpu, media, lights)
        self._make_sum()

    def _make_sum(self) -> None:
        gpu, size = self.media.gpu, self.rays.reduced
        self._sum = Texture(gpu, "shadow volumes", size, "rgba32float", target=True, written=True)

    def resize(self) -> None:
        """Go on with images of the size of the rays."""
        self._sum.release()
        self._make_sum()

    def prepare(self, commands: Commands) -> None:
        """Bring the boundaries up to date, where shadow maps changed."""
        self.parallel.encode(commands)
        self.local.encode(commands)

    def encode(self, commands: Commands, lights: Lights, scattered: Texture) -> None:
        """Fill `scattered`, of the size of `rays.reduced`: radiance, W m^-2 sr^-1."""
        rays = self.rays
        of_rays = {"rays": rays.params, "picked": rays.picked}
        shared = {**of_rays, "lights": lights.table, **self.media.bound}
        # F(surface) of all lights.
        self._lit.draw(commands, (self._sum,), params=LitParams(light_count=lights.count), **shared)
        target = {"view": self._sum.resource, "load_op": "load", "store_op": "store"}
        clip = _clip_from_eye(rays)
        # Plus and minus F at the faces of the shadow volumes of every map.
        with commands.render("shadow volumes", color_attachments=[target]) as encoder:
            encoder.set_pipeline(self._dark.pipeline)
            for trees in (self.parallel, self.local):
                for layer in range(trees.maps.layers):
                    drawn = VolumeParams(
                        clip_from_eye=clip,
                        light_count=lights.count,
                        is_parallel=int(trees is self.parallel),
                    )
                    self._dark.bindings.bind(
                        commands, encoder, 0, {**shared, "params": drawn, **trees.bound(layer)}
                    )
                    encoder.draw_indirect(trees.draws.handle, Draw.dtype.itemsize * layer)
        # Where all is dark a sum of many terms may end below zero.
        self._clamp.dispatch(commands, rays.reduced, summed=self._sum, scattered=scattered)


def _check(gpu: Gpu, media: GpuMedia) -> None:
    # F has a closed form in one homogeneous box alone.
    if not media.is_one_box:
        raise SettingsError(
            "shafts = 'volumes' draws one homogeneous box, and the scene has other media",
            remedy="Use shafts = 'minmax', the same light by another method",
        )
    # Terms of both signs cancel, which half floats would not leave clean.
    if FEATURE not in gpu.features:
        raise SettingsError(
            f"shafts = 'volumes' adds up in a 32-bit float target, and {gpu.info.name} lacks "
            f"{FEATURE}",
            remedy="Use shafts = 'minmax', the same light by another method",
        )


def _clip_from_eye(rays: Rays) -> F64:
    """Onto the reduced image, whose last texels may reach beyond the full one."""
    params = rays.params
    # With the eye as origin, near which positions are accurate.
    world_from_clip = params.record["world_from_clip"].T.astype(np.float64)
    eye_from_clip = world_from_clip.copy()
    eye_from_clip[:3] -= np.outer(params.record["eye"], world_from_clip[3])
    kx, ky = np.array(rays.size) / (rays.scale * np.array(rays.reduced))
    onto = np.array([[kx, 0, 0, kx - 1], [0, ky, 0, 1 - ky], [0, 0, 1, 0], [0, 0, 0, 1]])
    return np.asarray(onto @ np.linalg.inv(eye_from_clip))
