"""Light that enters a lattice, W per cell, before it propagates (Billeter2012 sections 3.1, 4.1).

the sky's maps          -> reflected, scattered once -> static, while nothing it reads changes
reflective shadow maps  -> virtual point lights, random points of rays   -> reflected
lights' shadow maps     -> scattered once, gathered by each cell         -> source
an endless medium       -> scattered before it comes in, at the border   -> source, beams
media that scatter forwards -> light deflected once, beside the lattice  -> forward
"""

from __future__ import annotations

import numpy as np

from ..fields import ForwardSource, Frame
from ..gpu.commands import Commands
from ..gpu.memory import Buffer, buffer_of
from ..lattice.inject import Inject, MapLights, Resolve, fixed_point_scale, flux_bound, new_sums
from ..lattice.lobes import InjectionTarget, Lobe
from ..lattice.point_lights import InjectPoints
from ..lighting.kit import Kit
from ..maths.lattice26_walls import returned_sharpness
from ..scene.medium import medium_box
from ..scene.scene import Scene
from ..surface.light_maps import BLOCK, LightMaps
from ..surface.light_table import LightData, packed_lights
from .cell_lights import CellLights
from .cells import LatticeCells, sky_capacity
from .forward import ForwardLight
from .inject_border import InjectBorder, Outside
from .inject_rays import InjectRays, Sampling, owner_rows
from .inject_single import InjectSingle
from .reduced import reduced_scene
from .settings import ScatterSettings

_RETURNED = Lobe(returned_sharpness())


class Injection:
    """Fills `source`, W per cell and channel, from the kit's lights and sky in `cells`."""

    def __init__(
        self, kit: Kit, scene: Scene, settings: ScatterSettings, cells: LatticeCells
    ) -> None:
        gpu, placement = kit.gpu, kit.placement
        self.settings, self.cells, self.placement = settings, cells, placement
        self.meshes, self.lights, self.sky = kit.meshes, kit.lights, kit.sky
        self.blockers = kit.blockers
        # Reflective shadow maps of the lights, and whose each layer is.
        # Random points of rays are drawn for every texel.
        block = 1 if settings.single in ("random", "stratified") else BLOCK
        self.maps = LightMaps(gpu, scene.lights, settings.map_resolution, block=block)
        self._map_lights = [
            MapLights(kit.lights.table, buffer_of(gpu, "map owners", owner_rows(owners)))
            for owners in self.maps.owners
        ]
        most = max(1, sky_capacity(kit))
        self._sky_lights = MapLights(
            Buffer(gpu, "sky lights", LightData.dtype.itemsize * most),
            buffer_of(gpu, "sky owners", owner_rows([*range(most)])),
        )
        # Passes for the lights and for the sky, which media attenuate differently.
        self._reflected, self._rays = Inject(gpu, cells.media), InjectRays(gpu, cells.media)
        self._single = InjectSingle(gpu, cells.media)
        self._sky_reflected = Inject(gpu, cells.sky_media)
        self._sky_single = InjectSingle(gpu, cells.sky_media)
        self.forward = ForwardLight(gpu, placement, cells.media, cells.sky_media, kit.lights.count)
        self._points, self._resolve = InjectPoints(gpu), Resolve(gpu)
        is_endless = scene.medium is not None and scene.medium.endless
        self._border = InjectBorder(gpu, placement, cells.media) if is_endless else None
        self._sums = new_sums(gpu, placement)
        self.black, self.static, self.reflected, self.source = (
            Buffer(gpu, name, 3 * placement.cells * 16)
            for name in ("no light", "static light", "reflected", "source")
        )
        self.flux = 0.0
        """W, an upper bound of what enters the lattice."""
        self._static_key = b""

    def encode(self, commands: Commands, frame: Frame, *, is_new: bool) -> None:
        """Fill `source`, and `forward` where media scatter forwards.

        `is_new`: walls or media are others than before.
        """
        scene = frame.scene
        self.flux = flux_bound([*scene.lights, *self.sky.lights], *frame.bounds)
        self.flux += self._points.take(scene.light_groups)
        scale = fixed_point_scale(self.flux, returned_sharpness())
        # Light that surfaces reflect, of lights and of the sky, as virtual point lights.
        with commands.stage("reflective shadow maps"):
            self.maps.encode(commands, self.meshes, scene.lights, *frame.bounds)
        with commands.stage("sky"):
            self._inject_sky(commands, scale, is_new=is_new)
        with commands.stage("reflected"):
            self._inject_reflected(commands, scale)
        with commands.stage("aggregate"):
            self._sum_up(commands, self.static, self.reflected, scale)
        # Light that media scatter for the first time, or that comes in scattered from outside.
        with commands.stage("single-scattered"):
            is_gathered = self.settings.single == "gather"
            self._single.encode(
                commands,
                self.placement,
                self._cell_lights(self.lights.count if is_gathered else 0),
                base=self.reflected,
                cells=self.source,
            )
            self._inject_border(commands, frame, is_new=is_new)
            self._take_forward(commands, scene)

    @property
    def beams(self) -> Buffer | None:
        """Unscattered light, W m, that marching reads from cells beside the scene's lights."""
        if self._border:
            return self._border.beams
        return self._sky_forward if self.cells.has_forward else None

    @property
    def surface_beams(self) -> Buffer | None:
        """Unscattered light, W m, that surfaces read: of the sky, and of lights deflected once."""
        return self.forward.all if self.cells.has_forward else self._given_beams

    def forward_source(self) -> ForwardSource | None:
        """Light that is deflected once, light by light, for marching."""
        is_lit = self.cells.has_forward and self.lights.count > 0
        return self.forward.source(self.lights.table) if is_lit else None

    @property
    def _given_beams(self) -> Buffer | None:
        """Those for surfaces without the lights' own."""
        return self._border.surface_beams if self._border else self.beams

    @property
    def _sky_forward(self) -> Buffer:
        has_any = self.cells.has_forward and self.sky.lights and self.sky.maps.layers
        return self.forward.sky if has_any else self.black

    def _cell_lights(self, count: int) -> CellLights:
        return CellLights(self.lights.bound, count, self.blockers.walls)

    def _inject_sky(self, commands: Commands, scale: float, *, is_new: bool) -> None:
        """Fill `static`, which changes only with environment, media or geometry."""
        table = packed_lights(tuple(self.sky.lights))
        key = table.tobytes() + np.float64(scale).tobytes()
        if key == self._static_key and not is_new:
            return
        self._static_key = key
        base, maps = self.black, self.sky.maps
        if self.sky.lights and maps.layers:
            self._sky_lights.table.write(table)
            resources = {
                **self.lights.bound,
                "lights": self._sky_lights.table,
                "parallel_views": maps.views,
                "parallel_shadows": maps.depth,
            }
            count = len(self.sky.lights) if self.settings.single != "off" else 0
            lights, base = CellLights(resources, count, self.blockers.walls), self.source
            # What media scatter of it, once or forwards, then what surfaces reflect.
            self._sky_single.encode(commands, self.placement, lights, base=self.black, cells=base)
            if self.cells.has_forward:
                visibility = self.blockers.face_visibility
                self.forward.encode_sky(
                    commands, lights, black=self.black, face_visibility=visibility
                )
            target = self._target(scale)
            self._sky_reflected.encode(commands, maps, target, _RETURNED, lights=self._sky_lights)
        self._sum_up(commands, base, self.static, scale)

    def _inject_reflected(self, commands: Commands, scale: float) -> None:
        """Add virtual point lights, and random points of rays where settings ask for them."""
        target, s = self._target(scale), self.settings
        sampling = Sampling(s.samples, s.seed, is_stratified=s.single == "stratified")
        self._points.encode(commands, target)
        for maps, lights in zip(self.maps.groups, self._map_lights, strict=True):
            if not maps.layers:
                continue
            self._reflected.encode(commands, maps, target, _RETURNED, lights=lights)
            if s.single in ("random", "stratified"):
                self._rays.encode(commands, maps, target, lights=lights, sampling=sampling)

    def _inject_border(self, commands: Commands, frame: Frame, *, is_new: bool) -> None:
        """Add what an endless medium around the lattice sends into it."""
        medium = reduced_scene(frame.scene).medium
        if self._border and medium:
            eye = frame.scene.camera.position
            top = float(medium_box(medium, *frame.bounds, eye)[1][1])
            outside = Outside(medium, top, (*frame.scene.lights, *self.sky.lights))
            walls = self.cells.reflectance
            self._border.find(commands, outside, self.blockers, walls, is_new=is_new)
            self._border.encode(commands, self.source, self._sky_forward)

    def _take_forward(self, commands: Commands, scene: Scene) -> None:
        if self.cells.has_forward:
            self.forward.encode(
                commands,
                scene,
                self._cell_lights(len(scene.lights)),
                base=self._given_beams or self.black,
                face_visibility=self.blockers.face_visibility,
            )

    def _target(self, scale: float) -> InjectionTarget:
        return InjectionTarget(self.placement, self.blockers.walls, self._sums, scale)

    def _sum_up(self, commands: Commands, base: Buffer, cells: Buffer, scale: float) -> None:
        # Sums are W sr^-1; cells hold power.
        unit = scale / (4.0 * np.pi)
        self._resolve.encode(commands, self.placement, self._sums, base, cells, unit)
