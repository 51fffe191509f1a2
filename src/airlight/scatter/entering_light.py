"""What all lattices of a scene share of the light that enters them: maps, lights, passes.

begin   reflective shadow maps are drawn, the sky's lights packed, the power bounded
inject_*, gather_*   one lattice's share, which `Injection` asks for
"""

from __future__ import annotations

import numpy as np

from ..fields import Frame
from ..gpu.commands import Commands
from ..gpu.memory import buffer_of
from ..lattice.inject import Inject, MapLights, Resolve, fixed_point_scale, flux_bound
from ..lattice.lobes import InjectionTarget, Lobe
from ..lattice.point_lights import InjectPoints
from ..lighting.kit import Kit
from ..maths.lattice26_walls import free_sharpness, returned_sharpness
from ..maths.transforms import F64
from ..scene.scene import Scene
from ..surface.light_maps import BLOCK, LightMaps
from .forward_textures import ForwardTextures
from .inject_rays import InjectRays, Sampling, owner_rows
from .inject_single import InjectSingle
from .reduced_media import ReducedMedia
from .settings import ScatterSettings
from .sky_table import SkyTable


class EnteringLight:
    """Lights and sky of one scene, as they enter lattices."""

    def __init__(
        self,
        kit: Kit,
        scene: Scene,
        settings: ScatterSettings,
        media: ReducedMedia,
        *,
        keeps_light: bool = False,
    ) -> None:
        """`keeps_light`: each lattice keeps the fluence of unscattered light in its cells."""
        gpu, self.keeps_light = kit.gpu, keeps_light
        self.kit, self.settings, self.media = kit, settings, media
        is_ours = not settings.scheme.startswith("paper")
        self._returned = Lobe(returned_sharpness(), is_raised=is_ours, free=free_sharpness())
        # Reflective shadow maps of the lights, and whose each layer is.
        # Random points of rays are drawn for every texel.
        self._has_rays = settings.single in ("random", "stratified")
        block = 1 if self._has_rays else BLOCK
        self.maps = LightMaps(gpu, scene.lights, settings.map_resolution, block=block)
        self._map_lights = [
            MapLights(kit.lights.table, buffer_of(gpu, "map owners", owner_rows(owners)))
            for owners in self.maps.owners
        ]
        self.sky = SkyTable(kit)
        owners = owner_rows([*range(self.sky.capacity)])
        self._sky_lights = MapLights(self.sky.buffer, buffer_of(gpu, "sky owners", owners))
        # Passes for the lights and for the sky, which media attenuate differently.
        self._reflected, self._rays = Inject(gpu, media.lights), InjectRays(gpu, media.lights)
        self.single = InjectSingle(gpu, media.lights, keeps_light=keeps_light)
        self._sky_reflected = Inject(gpu, media.sky)
        self.sky_single = InjectSingle(gpu, media.sky, keeps_light=keeps_light, is_first=True)
        self.forward = ForwardTextures(
            gpu, kit.lattices.placements, kit.lattices.texture_size, kit.lights.count
        )
        # Point lights of groups; and fixed-point sums, which become power.
        self._points, self.resolve = InjectPoints(gpu), Resolve(gpu)
        self.flux, self.scale = 0.0, 1.0
        """W, an upper bound of what enters a lattice; fixed-point units per W sr^-1."""
        self.sky_key = b""
        """Equal as long as the sky's lights and the scale are."""

    def _box(self, frame: Frame) -> tuple[F64, F64]:
        """What light comes into: the surfaces' box, with a medium far beyond them the lattice's."""
        low, high = frame.bounds
        # Light matters where surfaces are, unless lattices follow a medium far beyond them.
        if self.kit.lattices.nest.inner is None:
            return low, high
        first, last = self.kit.placement.world_bounds
        return np.minimum(low, first), np.maximum(high, last)

    def begin(self, commands: Commands, frame: Frame) -> None:
        """Draw the maps of the frame's lights."""
        scene, sky = frame.scene, self.kit.sky
        # Sums are in fixed point, as fine as an upper bound of all power allows.
        self.flux = flux_bound([*scene.lights, *sky.lights], *self._box(frame))
        self.flux += self._points.take(scene.light_groups)
        self.scale = fixed_point_scale(self.flux, returned_sharpness())
        self.forward.set_scale(scene.lights)
        # Lights of the sky are injected again where they or the scale change.
        self.sky.update()
        self.sky_key = self.sky.rows + repr(self.scale).encode()
        # Light that surfaces reflect, of lights and of the sky, as virtual point lights.
        with commands.stage("reflective shadow maps"):
            self.maps.encode(commands, self.kit.meshes, scene.lights, *frame.bounds)

    def inject_sky(self, commands: Commands, target: InjectionTarget) -> None:
        """Add what surfaces reflect of the sky to a lattice's sums."""
        maps = self.kit.sky.maps
        self._sky_reflected.encode(commands, maps, target, self._returned, lights=self._sky_lights)

    def inject_reflected(self, commands: Commands, target: InjectionTarget) -> None:
        """Add virtual point lights, and random points of rays where settings ask for them."""
        s = self.settings
        sampling = Sampling(s.samples, s.seed, is_stratified=s.single == "stratified")
        # Points of groups, then what the texels of each map reflect and media before them scatter.
        self._points.encode(commands, target)
        for maps, lights in zip(self.maps.groups, self._map_lights, strict=True):
            if not maps.layers:
                continue
            self._reflected.encode(commands, maps, target, self._returned, lights=lights)
            if self._has_rays:
                self._rays.encode(commands, maps, target, lights=lights, sampling=sampling)
