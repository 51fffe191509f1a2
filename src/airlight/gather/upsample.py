"""From gather points to pixels: the irradiance of the points around, with each pixel's own detail.

Points are blocks of pixels apart. What rays said of them holds for a pixel between as far as it is
like them; how its light differs by its normal (relief, curvature) and by near occluders, the
lattices and the search for occluders say.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.fullscreen import FullscreenPass
from ..gpu.memory import Texture, linear_sampler
from ..gpu.slots import storage, texture, uniform
from ..lattice.irradiance import Irradiance, SkyIrradiance
from ..lighting.gathered import Gathered
from ..lighting.kernel import LATTICES_FIRST, LatticeLight
from ..lighting.kit import Kit
from ..lighting.slots import LATTICE_SLOTS
from ..lighting.view import View
from .point_params import PointParams
from .points import Points
from .sums import read_sums


class _Upsample(FullscreenPass):
    slots = (
        uniform("params", PointParams),
        texture("depth", "2d", "depth"),
        texture("albedo", "2d", "unfilterable-float"),
        texture("normal", "2d", "unfilterable-float"),
        texture("places", "2d", "unfilterable-float"),
        texture("planes", "2d", "unfilterable-float"),
        read_sums("sums"),
        storage("orphans", "u32"),
        *LATTICE_SLOTS,
    )
    targets = ("rgba16float", "rgba16float")
    file = "upsample.wgsl"


class Upsampling:
    """Sums of points -> irradiance of pixels."""

    def __init__(self, gpu: Gpu, kit: Kit, points: Points, rays: int) -> None:
        """`rays`: of a point."""
        self._kit, self._points, self._rays = kit, points, rays
        # Where no point is like a pixel, lattices light it: as many as there are.
        light = LatticeLight(
            is_occluded=kit.settings.ambient_occlusion,
            has_sky=kit.sky.maps.layers > 0,
            is_one_lattice=kit.lattices.table.count == 1,
        )
        self._pass = _Upsample(gpu, constants=light.constants, firsts=LATTICES_FIRST)
        # Light of surfaces and of the sky apart, since near occluders send some of the first.
        irradiance, sky = (
            Texture(gpu, label, points.size, "rgba16float", target=True, written=True)
            for label in ("gathered irradiance", "gathered sky")
        )
        self.gathered = Gathered(irradiance, sky)
        self._linear = linear_sampler(gpu)

    def encode(
        self,
        commands: Commands,
        view: View,
        sums: Texture,
        irradiance: Irradiance,
        sky: SkyIrradiance,
    ) -> Gathered:
        """The irradiance of a view's pixels; `sums`: the image of those of its points."""
        points, gbuffer = self._points, view.gbuffer
        self._pass.draw(
            commands,
            (self.gathered.irradiance, self.gathered.sky),
            params=points.params(view, self._rays),
            depth=gbuffer.depth,
            albedo=gbuffer.albedo,
            normal=gbuffer.normal,
            places=points.places,
            planes=points.planes,
            sums=sums,
            orphans=points.orphans.buffer,
            near_field=view.occlusion.near,
            sky_cube=sky.cube,
            linear_clamp=self._linear,
            **irradiance.bound,
            **self._kit.blockers.surface_bound,
        )
        return self.gathered
