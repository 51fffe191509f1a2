"""Light scattered many times, solved on one lattice (Billeter2012), top to bottom.

reflective shadow maps, first-scattered light, the sky -> cells -> 26 neighbours -> fields
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ..fields import Fields, Frame, LatticeSource, ReflectedLight, Solver
from ..gpu.commands import Commands
from ..gpu.memory import Buffer, buffer_of
from ..lattice.inject import Inject, MapLights, Resolve, fixed_point_scale, flux_bound, new_sums
from ..lattice.irradiance import Irradiance
from ..lattice.lobes import InjectionTarget, Lobe
from ..lattice.point_lights import InjectPoints
from ..lighting.kit import Kit
from ..lighting.view import View
from ..maths.lattice26_walls import returned_sharpness
from ..maths.transforms import F64
from ..media.gpu_media import GpuMedia
from ..scene.medium import medium_box
from ..scene.scene import Scene
from ..surface.light_maps import LightMaps
from ..surface.light_table import LightData, packed_lights
from .cell_medium import CellMedium
from .emission import Emission
from .forward import ForwardLight
from .hop_visibility import CellReflectance
from .inject_border import InjectBorder
from .inject_rays import InjectRays, Sampling, owner_rows
from .inject_single import InjectSingle
from .level import LatticeKind
from .levels import Levels
from .reduced import is_forward, reduced_scene
from .schedule import Schedule, cycles_to, iterations_to, schedule
from .settings import ScatterSettings, densest_medium, is_varied
from .surface_light import SurfaceLight

_RETURNED = Lobe(returned_sharpness())
_SKY_COLUMNS = 16  # texels along a density grid's columns towards each sky light


class ScatterSolver(Solver):
    """Yields the irradiance of surfaces and the mean radiance that media scatter."""

    def __init__(self, kit: Kit, settings: ScatterSettings, *, has_volumes: bool = True) -> None:
        """`has_volumes`: whether the scene's volumes are part of the lattice's medium.

        Raises SettingsError where the scheme cannot do the scene's media.
        """
        self.kit, self.settings, self.has_volumes = kit, settings, has_volumes
        self.gpu, self.meshes, self.placement = kit.gpu, kit.meshes, kit.placement
        self.lights, self.sky, self.blockers = kit.lights, kit.sky, kit.blockers
        scene = self._seen(kit.context.scene)
        self.is_varied = is_varied(scene, self.placement, settings)
        reduced = reduced_scene(scene)
        self.media = GpuMedia(self.gpu, reduced, light_count=self.lights.count)
        sky_scene = dataclasses.replace(reduced, lights=tuple(self.sky.lights))
        # A turning sky may bring more lights.
        most = max(len(self.sky.lights), self.sky.maps.layers)
        self.sky_media = GpuMedia(
            self.gpu, sky_scene, light_count=most, column_resolution=_SKY_COLUMNS
        )
        self.maps = LightMaps(self.gpu, scene.lights, settings.map_resolution)
        self._map_lights = [
            MapLights(self.lights.table, buffer_of(self.gpu, "map owners", owner_rows(owners)))
            for owners in self.maps.owners
        ]
        self._sky_lights = MapLights(
            Buffer(self.gpu, "sky lights", LightData.dtype.itemsize * max(1, most)),
            buffer_of(self.gpu, "sky owners", owner_rows([*range(max(1, most))])),
        )
        self._make_passes(scene)

    def _seen(self, scene: Scene) -> Scene:
        """The scene as the lattice sees it."""
        return scene if self.has_volumes else dataclasses.replace(scene, volumes=())

    def _make_passes(self, scene: Scene) -> None:
        gpu, cells = self.gpu, self.placement.cells
        self.inject_reflected = Inject(gpu, self.media)
        self.inject_rays = InjectRays(gpu, self.media)
        self.inject_single = InjectSingle(gpu, self.media)
        self.sky_reflected = Inject(gpu, self.sky_media)
        self.sky_single = InjectSingle(gpu, self.sky_media)
        self.forward = ForwardLight(
            gpu, self.placement, self.media, self.sky_media, self.lights.count
        )
        self._is_forward = self._is_reduced = False
        self.resolve = Resolve(gpu)
        self.points = InjectPoints(gpu)
        is_endless = scene.medium is not None and scene.medium.endless
        self.border = InjectBorder(gpu, self.placement, self.media) if is_endless else None
        self.reflectance_of = CellReflectance(gpu)
        self.cell_medium = CellMedium(gpu, self.media) if self.is_varied else None
        self.sums = new_sums(gpu, self.placement)
        self.black, self.static, self.reflected, self.source = (
            Buffer(gpu, name, 3 * cells * 16)
            for name in ("no light", "static light", "reflected", "source")
        )
        self.medium = Buffer(gpu, "medium of cells", 3 * cells * 8 if self.is_varied else 16)
        self.reflectance = Buffer(gpu, "reflectance of cells", cells * 4)
        scheme = self.settings.scheme
        kind = LatticeKind(
            has_walls=self.settings.occlusion,
            is_varied=self.is_varied,
            scheme=scheme if scheme.startswith("paper") else "deposit",
            is_straight=any(densest_medium(scene)[1]),
        )
        plan = self._schedule(reduced_scene(scene))
        self.levels = Levels(gpu, self.placement.count, self.placement.cell, plan, kind)
        self.emission = Emission(gpu, self.placement)
        self.surfaces = SurfaceLight(gpu, self.placement)
        self._sigma_s = self._sigma_t = self._densest = (0.0, 0.0, 0.0)
        self._media_version = -1
        self._walls_key = self._static_key = b""

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """Inject what surfaces reflect and media scatter once, propagate, make textures of it.

        Raises SettingsError (scheme paper in a dense medium).
        """
        scene, (low, high) = self._seen(frame.scene), frame.bounds
        flux = flux_bound([*scene.lights, *self.sky.lights], low, high)
        flux += self.points.take(scene.light_groups)
        scale = fixed_point_scale(flux, returned_sharpness())
        # What the lattice's cells hold: the reduced media, and the walls between them.
        with commands.stage("air"):
            is_new = self._take_media(commands, scene, low, high)
        with commands.stage("prepare blockers"):
            is_new = self._take_walls(commands) or is_new
        # Light that surfaces reflect, of lights and of the sky, as virtual point lights.
        with commands.stage("reflective shadow maps"):
            self.maps.encode(commands, self.meshes, scene.lights, low, high)
        with commands.stage("sky"):
            self._inject_static(commands, scale, is_new=is_new)
        with commands.stage("reflected"):
            self._inject_reflected(commands, scale)
        with commands.stage("aggregate"):
            self._resolve(commands, self.static, self.reflected, scale)
        # Light that media scatter for the first time, or that comes in scattered from outside.
        with commands.stage("single-scattered"):
            self._inject_single(commands)
            self._inject_border(commands, scene, low, high, is_new=is_new)
            self._take_forward(commands, scene)
        # Everything that follows: scattered and reflected again and again.
        with commands.stage("propagate"):
            total, track = self.levels.encode(commands, self.source)
        # The track becomes mean radiance in media, the states irradiance of surfaces.
        with commands.stage("copy"):
            forward = self.forward if self._is_forward else None
            self.emission.encode(commands, track, flux, self._beams, sigma_t=self._densest)
            self.surfaces.encode(
                commands,
                total,
                flux,
                medium=self.medium if self.is_varied else None,
                sigma_s=self._sigma_s,
                sigma_t=self._sigma_t,
                forward=forward.all if forward else self._surface_beams,
            )
        return self._added(frame.scene, fields)

    def _added(self, scene: Scene, fields: Fields) -> Fields:
        """The fields, with what was solved."""
        table = self.kit.lattices.table.filled([self.surfaces.params()])
        irradiance = Irradiance({"lattices": table, **self.surfaces.bound}, is_reflected=True)
        light = self.marched()
        version = (scene.lights, scene.environment, scene.medium, self.meshes.version)
        return dataclasses.replace(
            fields, irradiance=irradiance, scattered=light, reflected=ReflectedLight(light, version)
        )

    def solve_view(self, commands: Commands, view: View, fields: Fields) -> Fields:
        """The lattice does not depend on the eye."""
        return fields

    def _take_media(self, commands: Commands, scene: Scene, low: F64, high: F64) -> bool:
        reduced, self._is_forward = reduced_scene(scene), is_forward(scene)
        self._is_reduced = is_forward(scene, least=0.0)
        self.media.update(commands, reduced, low, high)
        sky = dataclasses.replace(reduced, lights=tuple(self.sky.lights))
        self.sky_media.update(commands, sky, low, high)
        if self.media.version == self._media_version:
            return False
        self._media_version = self.media.version
        self._densest = densest_medium(reduced)[1]
        if self.cell_medium is None:
            self._sigma_s, self._sigma_t = densest_medium(reduced)
            self.levels.set_homogeneous(self._sigma_s, self._sigma_t)
            return True
        self.cell_medium.encode(commands, self.placement, self.medium, self._samples())
        self.levels.set_varied(commands, self.medium)
        return True

    def _samples(self) -> int:
        """Sample points per cell and axis: one per voxel of the finest grid, within reason."""
        fine = self.placement.cell / self.media.finest_voxel_m
        return int(min(max(np.ceil(fine), 3), 6))

    def _take_walls(self, commands: Commands) -> bool:
        key = str(self.meshes.version).encode()
        if key == self._walls_key:
            return False
        self._walls_key = key
        if self.settings.occlusion:
            self.reflectance_of.encode(
                commands, self.placement.count, self.blockers.faces, self.reflectance
            )
            self.levels.set_walls(commands, self.blockers.face_visibility, self.reflectance)
        return True

    def _inject_static(self, commands: Commands, scale: float, *, is_new: bool) -> None:
        """Inject what changes only with environment, media or geometry: the sky's light."""
        table = packed_lights(tuple(self.sky.lights))
        key = table.tobytes() + np.float64(scale).tobytes()
        if key == self._static_key and not is_new:
            return
        self._static_key = key
        place, walls = self.placement, self.blockers.walls
        base = self.black
        if self.sky.lights and self.sky.maps.layers:
            self._sky_lights.table.write(table)
            maps = self.sky.maps
            bound = {
                **self.lights.bound,
                "lights": self._sky_lights.table,
                "parallel_views": maps.views,
                "parallel_shadows": maps.depth,
            }
            count = len(self.sky.lights) if self.settings.single != "off" else 0
            self.sky_single.encode(
                commands, place, bound, count, walls=walls, base=self.black, cells=self.source
            )
            if self._is_forward:
                self.forward.encode_sky(
                    commands,
                    bound,
                    count,
                    black=self.black,
                    walls=walls,
                    face_visibility=self.blockers.face_visibility,
                )
            self.sky_reflected.encode(
                commands, maps, self._target(scale), _RETURNED, lights=self._sky_lights
            )
            base = self.source
        self._resolve(commands, base, self.static, scale)

    def _target(self, scale: float) -> InjectionTarget:
        return InjectionTarget(self.placement, self.blockers.walls, self.sums, scale)

    def _inject_reflected(self, commands: Commands, scale: float) -> None:
        target, s = self._target(scale), self.settings
        sampling = Sampling(s.samples, s.seed, is_stratified=s.single == "stratified")
        self.points.encode(commands, target)
        for maps, lights in zip(self.maps.groups, self._map_lights, strict=True):
            if not maps.layers:
                continue
            self.inject_reflected.encode(commands, maps, target, _RETURNED, lights=lights)
            if s.single in ("random", "stratified"):
                self.inject_rays.encode(commands, maps, target, lights=lights, sampling=sampling)

    def _inject_single(self, commands: Commands) -> None:
        count = self.lights.count if self.settings.single == "gather" else 0
        self.inject_single.encode(
            commands,
            self.placement,
            self.lights.bound,
            count,
            walls=self.blockers.walls,
            base=self.reflected,
            cells=self.source,
        )

    def _inject_border(
        self, commands: Commands, scene: Scene, low: F64, high: F64, *, is_new: bool
    ) -> None:
        reduced = reduced_scene(scene).medium
        if self.border and reduced:
            top = float(medium_box(reduced, low, high, scene.camera.position)[1][1])
            lights = [*scene.lights, *self.sky.lights]
            walls = self.reflectance if self.settings.occlusion else None
            self.border.find(commands, reduced, top, lights, self.blockers, walls, is_new=is_new)
            self.border.encode(commands, self.source, self._sky_forward)

    @property
    def _sky_forward(self) -> Buffer:
        has_any = self._is_forward and self.sky.lights and self.sky.maps.layers
        return self.forward.sky if has_any else self.black

    @property
    def _beams(self) -> Buffer | None:
        """Unscattered light that marching reads from cells, besides that of the scene's lights."""
        if self.border:
            return self.border.beams
        return self._sky_forward if self._is_forward else None

    @property
    def _surface_beams(self) -> Buffer | None:
        """The same for surfaces."""
        return self.border.surface_beams if self.border else self._beams

    def _take_forward(self, commands: Commands, scene: Scene) -> None:
        if self._is_forward:
            self.forward.encode(
                commands,
                scene,
                self.lights.bound,
                base=self._surface_beams or self.black,
                walls=self.blockers.walls,
                face_visibility=self.blockers.face_visibility,
            )

    def marched(self) -> LatticeSource:
        """For marching."""
        is_lit = self._is_forward and self.lights.count > 0
        beams = self.forward.source(self.lights.table) if is_lit else None
        return self.emission.source(self.blockers.bound, beams, is_reduced_medium=self._is_reduced)

    def _resolve(self, commands: Commands, base: Buffer, cells: Buffer, scale: float) -> None:
        # Sums are W sr^-1; cells hold power.
        unit = scale / (4.0 * np.pi)
        self.resolve.encode(commands, self.placement, self.sums, base, cells, unit)

    def _schedule(self, reduced: Scene) -> Schedule:
        s, count = self.settings, self.placement.count
        # The paper has one lattice.
        faster = "none" if s.scheme.startswith("paper") else s.acceleration
        steps = s.iterations
        if s.residual > 0.0 and faster == "cycle":
            steps = cycles_to(s.residual)
        elif s.residual > 0.0:
            sigma_s, sigma_t = densest_medium(reduced)
            steps = iterations_to(s.residual, sigma_s, sigma_t, self.placement.cell, count)
        plan = schedule(faster, steps, count)
        if any(densest_medium(reduced)[1]):
            return plan
        # In clear air the light of area lights is too bright; converged, it would be more so.
        return dataclasses.replace(plan, cycles=max(1, 2 * plan.cycles // 3), is_rescaled=False)

    @property
    def stats(self) -> dict[str, object]:
        """What was solved, for --stats."""
        plan = self.levels.schedule
        return {
            "lattice": list(self.placement.count),
            "iterations": plan.iterations,
            "levels": len(self.levels.levels),
            "cycles": plan.cycles,
        }
