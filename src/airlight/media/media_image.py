"""The image of media: single scattering of lights, marched fields, transmittance.

shaft rays -> shafts (single scattering)      march rays -> march (fields of solvers, the sky)
reduced images -> upsampled and composed with surfaces, in one pass where a device can
"""

from __future__ import annotations

from dataclasses import replace

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..lighting.lights import Lights
from ..lighting.view import View
from ..maths.transforms import F64
from ..scene.scene import Scene
from .compositing.compose import Compose
from .compositing.finish import Finish, Listing, MediaLayers, Reduced, can_finish
from .compositing.guided import GuidedUpsample
from .compositing.transmittance import Transmittance
from .compositing.upsample import Upsample
from .density_grids import ColumnPlan
from .gpu_media import GpuMedia
from .image_textures import Drawn, Expected, ImageTextures
from .march.march import March, MarchTargets, Steps
from .march.marched_light import MarchedLight
from .rays import RESOLUTIONS, Rays
from .settings import MediaSettings
from .shafts.image import ShaftImage

_NOTHING = MarchedLight()


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
        # The media, with columns of their density towards the scene's lights.
        self.media = GpuMedia(
            gpu,
            scene,
            light_count=lights.count,
            solved=e.solved,
            has_local_shafts=e.has_local_shafts,
            columns=ColumnPlan(s.column_resolution, shared=e.shared),
        )
        # Shafts and marching take the same rays where both are reduced alike.
        march_rays = shaft_rays = Rays(gpu, size, RESOLUTIONS[s.march_resolution])
        if s.shaft_resolution != s.march_resolution:
            shaft_rays = Rays(gpu, size, RESOLUTIONS[s.shaft_resolution])
        self.march_rays, self.shaft_rays = march_rays, shaft_rays
        # What is drawn of the media: shafts of lights, and what is marched.
        self.shafts: ShaftImage | None = None
        if s.shafts != "off" and lights.count and self.media.has_shafts:
            self.shafts = ShaftImage(gpu, self.media, lights, self.shaft_rays, s)
        # The sky's single scattering is drawn where that of lights may be.
        self.has_sky = e.has_sky and bool(self.media.count) and s.shafts != "off"
        wanted = e.sources or e.has_lattice or self.has_sky or self.media.has_grids
        wanted = wanted or self.media.has_emission
        self.is_marched = bool(self.media.count and wanted)
        self.march = March(gpu, self.media, sources=e.sources)
        has_grids = self.media.has_grids
        drawn = Drawn(self.shafts is not None, self.is_marched, self.has_sky, has_grids)
        self.textures = ImageTextures(gpu, march_rays, shaft_rays, drawn)
        self._make_compositing(size)

    def _make_compositing(self, size: tuple[int, int]) -> None:
        """Make the passes from reduced images to full ones; all in one where a device can."""
        gpu, media, has_grids = self.gpu, self.media, self.media.has_grids
        # A pass for each step, where density grids or the device do not allow one for all.
        self._exact = Transmittance(gpu, media)
        self._upsample, self._upsample_onto = Upsample(gpu), Upsample(gpu, is_added=True)
        self._guided = GuidedUpsample(gpu, media) if has_grids else None
        self._finisher: Finish | None = None
        if self.is_marched and self.march_rays.scale > 1 and not has_grids and can_finish(gpu):
            self._finisher = Finish(gpu, media, has_sky=self.has_sky, lists=self._lists)
        # Set between `encode` and `compose` where one pass does both.
        self._unfinished: Lights | None = None
        self._composed = Compose(gpu, size) if self._finisher is None else None
        self._is_in_view = self._composed is None  # where `compose` left the surfaces

    @property
    def single_scatter(self) -> Texture:
        """Radiance scattered once, of lights and the sky, W m^-2 sr^-1."""
        return self.textures.single_scatter

    @property
    def multiple_scatter(self) -> Texture:
        """Radiance of all marched fields, W m^-2 sr^-1."""
        return self.textures.multiple_scatter

    @property
    def transmittance(self) -> Texture:
        """The transmittance of eye rays, rgb."""
        return self.textures.transmittance

    def resize(self, size: tuple[int, int]) -> None:
        """Go on with images of `size`, pixels; media, lights and passes stay."""
        self.textures.resize(size)
        if self.shafts:
            self.shafts.resize()
        if self._composed:
            self._composed.resize(size)

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
        # What schemes make of shadow maps: hierarchies of depth, or facets.
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
        # One pass finishes the image if it draws all that there is.
        is_whole = is_composed and self.has_sky == (light.sky is not None)
        # Shafts first; marching may take the same rays.
        with commands.stage("shafts"):
            self.shaft_rays.encode(commands, view, frame)
            if self.shafts:
                is_listed = bool(self._finisher and is_whole and self._lists)
                self._draw_shafts(commands, view, lights, is_listed=is_listed)
        with commands.stage("march"):
            if self.march_rays is not self.shaft_rays:
                self.march_rays.encode(commands, view, frame)
            # The full image is left to `compose` where one pass does both.
            if self._finisher and is_whole:
                self._march_reduced(commands, light)
                self._unfinished = lights
            else:
                self._march(commands, view, light)

    def _draw_shafts(
        self, commands: Commands, view: View, lights: Lights, *, is_listed: bool
    ) -> None:
        """Draw single scattering of lights; `is_listed`: `compose` upsamples and redraws it."""
        assert self.shafts
        reduced, full = self.textures.target("single"), self.textures.full("single")
        # Along reduced rays, then interpolated; pixels where that cannot be done are redrawn.
        self.shafts.encode(commands, lights, reduced)
        if not is_listed and not self.shafts.refine(commands, view, lights, reduced, full):
            self._upsampled(commands, view, "single")

    def _march(self, commands: Commands, view: View, light: MarchedLight) -> None:
        """March all fields; full-size images of them, of the sky's light and transmittance."""
        made, depth = self.textures, view.gbuffer.depth
        # Fields along reduced rays, then at full size.
        if self.is_marched:
            self._march_reduced(commands, light)
            self._finish_march(commands, view)
        # The sky's light on top of the shafts of lights.
        if light.sky is not None:
            self._upsample_onto.encode(
                commands,
                self.march_rays,
                depth,
                made.reduced["sky"],
                made.single_scatter,
                made.shafts_alone,
            )
        # Homogeneous media have a closed form; rays through grids found it while they marched.
        if not self.media.has_grids:
            self._exact.encode(commands, self.march_rays, depth, made.transmittance)

    def _march_reduced(self, commands: Commands, light: MarchedLight) -> None:
        # The light of an endless medium continues that of lattices.
        if light.lattice is None and light.sky is None:
            light = replace(light, half_space=None)
        made = self.textures
        # Of homogeneous media transmittance has a closed form; with grids it is marched, too.
        targets = MarchTargets(
            made.target("multiple"),
            made.target("transmittance") if self.media.has_grids else None,
            made.reduced.get("sky"),
        )
        steps = Steps(self.settings.steps_per_cell, self.settings.march_steps)
        self.march.encode(commands, self.march_rays, light, targets, steps)

    def _finish_march(self, commands: Commands, view: View) -> None:
        """Upsample what was marched; with the transmittance where there are density grids."""
        if self.march_rays.scale == 1:
            return
        # Depth guides the interpolation; where there are density grids, the density does.
        if self._guided is None:
            self._upsampled(commands, view, "multiple")
            return
        made = self.textures
        self._guided.encode(
            commands,
            self.march_rays,
            self.march,
            view.gbuffer.depth,
            MarchTargets(made.reduced["multiple"], made.reduced["transmittance"]),
            (made.multiple_scatter, made.transmittance),
        )

    def compose(self, commands: Commands, view: View) -> None:
        """Attenuate the layers of the view by the media; see `surfaces`."""
        with commands.stage("compose"):
            # Surfaces are attenuated in the view's own layers where one pass finishes everything.
            self._is_in_view = self._unfinished is not None
            if self._unfinished is not None:
                self._finish_all(commands, view, self._unfinished)
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

    def _finish_all(self, commands: Commands, view: View, lights: Lights) -> None:
        """Upsample what was drawn, and attenuate surfaces, in one pass."""
        finisher, made = self._finisher, self.textures
        assert finisher
        # That pass lists pixels to redraw, too, where shafts and marching take the same rays.
        listing: Listing | None = None
        if self.shafts and self._lists:
            redrawn, listed = self.shafts.listing(view)
            listing = Listing(listed, redrawn)
        reduced = Reduced(
            made.reduced["multiple"],
            made.reduced["single"] if listing else made.shafts_alone,
            made.reduced.get("sky"),
        )
        layers = MediaLayers(
            view.layers.targets, made.multiple_scatter, made.transmittance, made.single_scatter
        )
        finisher.encode(commands, self.march_rays, view.gbuffer.depth, reduced, layers, listing)
        # The pixels that the pass listed.
        if self.shafts and listing:
            with commands.stage("shafts"):
                self.shafts.redraw(commands, view, lights, made.single_scatter)

    @property
    def _lists(self) -> bool:
        """Whether the finishing pass upsamples shafts, too, and lists pixels to redraw."""
        is_shared = self.march_rays is self.shaft_rays
        return self.shafts is not None and self.shafts.can_list and is_shared

    def _upsampled(self, commands: Commands, view: View, name: str) -> None:
        made = self.textures
        rays = made.rays_of(name)
        # Along full-size rays it was drawn where it belongs.
        if rays.scale > 1:
            self._upsample.encode(
                commands, rays, view.gbuffer.depth, made.reduced[name], made.full(name)
            )
