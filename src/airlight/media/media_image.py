"""The image of media: single scattering of lights, marched fields, transmittance.

shaft rays -> shafts (single scattering)      march rays -> march (fields of solvers, the sky)
reduced images -> upsampled and composed with surfaces, in one pass where a device can
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.lights import Lights
from ..lighting.view import View
from ..maths.transforms import F64
from ..scene.scene import Scene
from ..scene.volume import Volume
from .compositing.compose import Compose
from .compositing.finish import Drawn, Finish, Listing, MediaLayers, can_finish
from .compositing.guided import GuidedUpsample
from .compositing.transmittance import Transmittance
from .compositing.upsample import Upsample, UpsampleOnto
from .gpu_media import GpuMedia
from .march.march import March, MarchedLight, MarchTargets, Steps
from .rays import RESOLUTIONS, RayParams, Rays
from .settings import MediaSettings
from .shafts.image import ShaftImage

_NOTHING = MarchedLight()


@dataclass(frozen=True)
class Expected:
    """What a `MediaImage` will be given to march: `sources` textures, a lattice, the sky's lattice.

    `solved`: volumes whose sources bring their single scattering, see `GpuMedia`.
    """

    sources: int = 0
    has_lattice: bool = False
    has_sky: bool = False
    solved: Sequence[Volume] = ()


class MediaImage:
    """Passes and textures of one image size; media and lights may move from frame to frame."""

    def __init__(
        self,
        gpu: Gpu,
        scene: Scene,
        size: tuple[int, int],
        lights: Lights,
        settings: MediaSettings | None = None,
        expected: Expected | None = None,
    ) -> None:
        """Raises SettingsError for a scheme of shafts that cannot draw the scene's media."""
        e = expected or Expected()
        self.gpu, self.settings = gpu, settings or MediaSettings()
        s = self.settings
        self.media = GpuMedia(
            gpu,
            scene,
            light_count=lights.count,
            solved=e.solved,
            column_resolution=s.column_resolution,
        )
        self.march_rays = Rays(gpu, size, RESOLUTIONS[s.march_resolution])
        self.shaft_rays = self.march_rays
        if s.shaft_resolution != s.march_resolution:
            self.shaft_rays = Rays(gpu, size, RESOLUTIONS[s.shaft_resolution])
        self.shafts: ShaftImage | None = None
        if s.shafts != "off" and lights.count and self.media.count:
            self.shafts = ShaftImage(gpu, self.media, lights, self.shaft_rays, s)
        self.has_sky = e.has_sky and bool(self.media.count) and s.shafts != "off"
        wanted = e.sources or e.has_lattice or self.has_sky or self.media.has_grids
        self.is_marched = bool(self.media.count and wanted)
        self.march = March(gpu, self.media, sources=e.sources)
        self._exact = Transmittance(gpu, self.media)
        self._upsample, self._upsample_onto = Upsample(gpu), UpsampleOnto(gpu)
        self._guided = GuidedUpsample(gpu, self.media) if self.media.has_grids else None
        self._finisher: Finish | None = None
        if self.is_marched and self.march_rays.scale > 1 and not self._guided and can_finish(gpu):
            self._finisher = Finish(gpu, self.media, has_sky=self.has_sky, lists=self._lists)
        # Set between `encode` and `compose` where one pass does both.
        self._unfinished: tuple[RayParams, Lights] | None = None
        self._composed = Compose(gpu, size) if self._finisher is None else None
        self._is_in_view = self._composed is None  # where `compose` left the surfaces
        self._make_images(size)

    def _make_images(self, size: tuple[int, int]) -> None:
        gpu = self.gpu

        def made(name: str, size: tuple[int, int], *, written: bool = False) -> Texture:
            return Texture(gpu, name, size, "rgba32float", target=True, written=written)

        # Kernels of shafts write to textures; all else is drawn to targets.
        self.single_scatter = made("single scatter", size, written=True)
        self.multiple_scatter = made("multiple scatter", size)
        self.transmittance = made("transmittance", size)
        # Single scattering of lights; that of the sky is added to it.
        self._shafts_alone = self.single_scatter
        if self.has_sky:
            self._shafts_alone = made("shafts", size, written=True)
        is_reduced = self.is_marched and self.march_rays.scale > 1
        wanted = {
            "single": self.shafts is not None and self.shaft_rays.scale > 1,
            "multiple": is_reduced,
            "transmittance": is_reduced and self.media.has_grids,
            "sky": self.has_sky,
        }
        self._reduced = {
            name: made(f"reduced {name}", self._rays_of(name).reduced, written=name == "single")
            for name, is_wanted in wanted.items()
            if is_wanted
        }

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with images of `size`, pixels; media, lights and passes stay."""
        for rays in {id(r): r for r in (self.march_rays, self.shaft_rays)}.values():
            rays.resize(size)
        if self.shafts:
            self.shafts.resize()
        for texture in (*self._images, *self._reduced.values()):
            texture.release()
        self._make_images(size)
        if self._composed:
            self._composed.resize(size)

    @property
    def _images(self) -> tuple[Texture, ...]:
        alone = (self._shafts_alone,) if self.has_sky else ()
        return (self.single_scatter, self.multiple_scatter, self.transmittance, *alone)

    def solve(
        self,
        commands: Commands,
        scene: Scene,
        low: F64,
        high: F64,
        *,
        shadows_changed: bool = True,
    ) -> None:
        """Bring media, column densities towards lights and shadow hierarchies up to date.

        low..high, metres: the scene's bounds, which a medium without its own fills.
        """
        with commands.stage("air"):
            self.media.update(commands, scene, low, high)
        if self.shafts and shadows_changed:
            with commands.stage("shadow bounds"):
                self.shafts.prepare(commands)

    def encode(
        self,
        commands: Commands,
        view: View,
        lights: Lights,
        light: MarchedLight = _NOTHING,
        *,
        frame: int = 0,
        is_composed: bool = False,
    ) -> None:
        """Fill the three textures, after the depth of `view`. `frame` varies the jitter.

        `is_composed`: `compose` follows, and fills them where one pass can do both.
        """
        self._unfinished = None
        is_whole = is_composed and self.has_sky == (light.sky is not None)
        with commands.stage("shafts"):
            shaft_params = self.shaft_rays.encode(commands, view, frame)
            if self.shafts:
                is_listed = bool(self._finisher and is_whole and self._lists)
                self._draw_shafts(commands, shaft_params, view, lights, is_listed=is_listed)
        with commands.stage("march"):
            is_shared = self.march_rays is self.shaft_rays
            params = shaft_params if is_shared else self.march_rays.encode(commands, view, frame)
            if self._finisher and is_whole:
                self._march_reduced(commands, params, light)
                self._unfinished = params, lights
            else:
                self._march(commands, params, view, light)

    def _draw_shafts(
        self,
        commands: Commands,
        params: RayParams,
        view: View,
        lights: Lights,
        *,
        is_listed: bool,
    ) -> None:
        """Draw single scattering of lights; `is_listed`: `compose` upsamples and redraws it."""
        assert self.shafts
        reduced, full = self._target("single"), self._full("single")
        self.shafts.encode(commands, params, view, lights, reduced)
        if is_listed:
            return
        if not self.shafts.refine(commands, params, view, lights, reduced, full):
            self._upsampled(commands, params, self.shaft_rays, view, "single")

    def _march(
        self, commands: Commands, params: RayParams, view: View, light: MarchedLight
    ) -> None:
        if self.is_marched:
            self._march_reduced(commands, params, light)
            self._finish_march(commands, params, view)
        if light.sky is not None:
            self._upsample_onto.encode(
                commands,
                params,
                self.march_rays,
                view.gbuffer.depth,
                self._reduced["sky"],
                self._shafts_alone,
                self.single_scatter,
            )
        if not self.media.has_grids:
            self._exact.encode(commands, params, view.gbuffer.depth, self.transmittance)

    def _march_reduced(self, commands: Commands, params: RayParams, light: MarchedLight) -> None:
        if light.lattice is None and light.sky is None:
            light = replace(light, half_space=None)
        targets = MarchTargets(
            self._target("multiple"),
            self._target("transmittance") if self.media.has_grids else None,
            self._reduced.get("sky"),
        )
        steps = Steps(self.settings.steps_per_cell, self.settings.march_steps)
        self.march.encode(commands, params, self.march_rays, light, targets, steps)

    def _finish_march(self, commands: Commands, params: RayParams, view: View) -> None:
        """Upsample what was marched; with the transmittance where there are density grids."""
        if self.march_rays.scale == 1:
            return
        if self._guided is None:
            self._upsampled(commands, params, self.march_rays, view, "multiple")
            return
        self._guided.encode(
            commands,
            params,
            self.march_rays,
            self.march,
            view.gbuffer.depth,
            MarchTargets(self._reduced["multiple"], self._reduced["transmittance"]),
            (self.multiple_scatter, self.transmittance),
        )

    def compose(self, commands: Commands, view: View) -> None:
        """Attenuate the layers of the view by the media; see `surfaces`."""
        with commands.stage("compose"):
            self._is_in_view = self._unfinished is not None
            if self._unfinished is not None:
                self._finish_all(commands, view, *self._unfinished)
                return
            self._composed = self._composed or Compose(self.gpu, view.size)
            self._composed.encode(
                commands,
                direct=view.layers.direct,
                indirect=view.layers.indirect,
                transmittance=self.transmittance,
            )

    def surfaces(self, view: View) -> tuple[Texture, Texture]:
        """Direct and indirect light through media: the view's own layers, if `compose` can."""
        if self._is_in_view or self._composed is None:
            return view.layers.targets
        return self._composed.layers

    def _finish_all(
        self, commands: Commands, view: View, params: RayParams, lights: Lights
    ) -> None:
        finisher = self._finisher
        assert finisher
        listing: Listing | None = None
        if self.shafts and self._lists:
            redrawn, listed = self.shafts.listing(view)
            listing = Listing(listed, redrawn)
        drawn = Drawn(
            self._reduced["multiple"],
            self._reduced["single"] if listing else self._shafts_alone,
            self._reduced.get("sky"),
        )
        layers = MediaLayers(
            view.layers.targets, self.multiple_scatter, self.transmittance, self.single_scatter
        )
        finisher.encode(commands, params, view.gbuffer.depth, drawn, layers, listing)
        # The pixels that the pass listed.
        if self.shafts and listing:
            with commands.stage("shafts"):
                self.shafts.redraw(commands, params, view, lights, self.single_scatter)

    @property
    def _lists(self) -> bool:
        """Whether the finishing pass upsamples shafts, too, and lists pixels to redraw."""
        is_shared = self.march_rays is self.shaft_rays
        return self.shafts is not None and self.shafts.can_list and is_shared

    def _full(self, name: str) -> Texture:
        return {
            "single": self._shafts_alone,
            "multiple": self.multiple_scatter,
            "transmittance": self.transmittance,
        }[name]

    def _target(self, name: str) -> Texture:
        """The target of a kernel: the reduced texture, or the full one where none is reduced."""
        return self._full(name) if self._rays_of(name).scale == 1 else self._reduced[name]

    def _rays_of(self, name: str) -> Rays:
        return self.shaft_rays if name == "single" else self.march_rays

    def _upsampled(
        self, commands: Commands, params: RayParams, rays: Rays, view: View, name: str
    ) -> None:
        if rays.scale > 1:
            self._upsample.encode(
                commands, params, rays, view.gbuffer.depth, self._reduced[name], self._full(name)
            )
