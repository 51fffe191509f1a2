"""The technique `lpv`: direct light, and light that bounced, on lattices (Kaplanyan2010)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, cast

import numpy as np

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..lattice.blockers import Blockers
from ..lattice.emission import InjectEmission, emitted_flux
from ..lattice.inject import (
    EVERYTHING,
    Inject,
    Resolve,
    SmallObjects,
    fixed_point_scale,
    flux_bound,
)
from ..lattice.lookup import texture_scale
from ..lattice.nested import nested
from ..lattice.placement import EVERYWHERE, Placement, triple
from ..lattice.point_lights import InjectPoints
from ..lattice.skylight import Skylight
from ..lighting.direct import Direct, SurfaceSettings
from ..lighting.lattice_box import lattice_box
from ..maths.lattice6 import Scheme, enough_steps, spread_kept
from ..scene.camera import Camera
from ..scene.lights import DirectionalLight, Light
from ..scene.scene import Scene
from ..scene.settings import setting
from ..surface.geometry import GpuScene
from ..surface.light_views import light_views, view_count
from ..surface.reflective import ReflectiveShadowMaps
from .border import Border
from .cascades import Cascade, cascade, follow
from .propagate import Propagate
from .seen_blockers import SOURCES, SeenBlockers
from .storage import STORAGES


@dataclass(frozen=True)
class LpvSettings(SurfaceSettings):
    """What light propagation volumes can be told."""

    scheme: str = setting("centroid", "how a hop keeps direction", choices=("centroid", "paper"))
    iterations: int = setting(0, "propagation steps; 0: 2 a cell, at least 64", low=0, high=1024)
    tail: bool = setting(
        True, "whether what all later steps would add is estimated, from 32 iterations on"
    )
    storage: str = setting("float32", "how lattices are kept between steps", choices=STORAGES)
    map_resolution: int = setting(
        256, "side of reflective shadow maps", unit="px", low=8, high=4096
    )
    surfel_source: str = setting("meshes", "what blockers are sampled from", choices=SOURCES)
    surfel_resolution: int = setting(
        128, "side of the views that blockers are taken from", unit="px", low=8, high=2048
    )
    peel_layers: int = setting(2, "depth layers of each of them", low=1, high=8)
    keep_surfels: bool = setting(True, "whether what views saw before still blocks, until it moves")
    occlusion: bool = setting(True, "whether surfaces stop propagating light")
    bounces: bool = setting(True, "whether stopped light bounces on, beyond the first bounce")
    cascades: int = setting(
        1, "nested lattices; but for the largest they follow the camera", low=1, high=6
    )
    cascade_ratio: float = setting(
        2.0, "how much larger the cells of the next lattice are", low=1.25, high=8.0
    )
    cascade_extent: float = setting(
        0.0, "side of the finest cascade; 0: cells of all differ by the ratio", unit="m",
        low=0.0, high=1e6,
    )  # fmt: skip
    small_objects: str = setting(
        "moving", "objects smaller than a cell that larger cascades leave out",
        choices=("moving", "all", "none"),
    )  # fmt: skip
    cascade_light: bool = setting(
        True, "whether finer cascades take in light from beyond their borders"
    )
    damping: float = setting(
        0.0, "how strongly light that falls off away from a surface is taken for a leak", low=0,
        high=10,
    )  # fmt: skip


class Lpv(Direct):
    """Reflective shadow maps -> virtual point lights -> cells -> propagation -> surfaces."""

    Settings: ClassVar[type[SurfaceSettings]] = LpvSettings

    def __init__(
        self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: LpvSettings,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        self.nest = nested(
            *lattice_box(scene, settings.bounds, in_air=self.is_in_air), settings.resolution,
            count=settings.cascades, ratio=settings.cascade_ratio, finest_m=settings.cascade_extent,
        )  # fmt: skip
        steps = settings.iterations or max(enough_steps(p.count) for p in self.nest.levels)
        self.lpv = replace(settings, iterations=steps)
        super().__init__(gpu, scene, meshes, self.lpv, size)
        self.is_paper, self.damping = settings.scheme == "paper", settings.damping
        self.is_bounced, self.is_bouncing = not self.is_paper, settings.bounces
        # The paper ignores blockers in the first step, so its lobes stay cosine lobes.
        self._is_shaped = settings.occlusion and not self.is_paper
        suns, lamps = _by_kind(scene.lights)
        lamp_side = max(8, settings.map_resolution // 2)
        self.sun_maps = ReflectiveShadowMaps(gpu, "suns", settings.map_resolution, len(suns))
        self.lamp_maps = ReflectiveShadowMaps(
            gpu, "lamps", lamp_side, sum(view_count(lamp) for lamp in lamps)
        )
        self.inject, self.emission, self.resolve = Inject(gpu), InjectEmission(gpu), Resolve(gpu)
        self.points = InjectPoints(gpu)
        self._steady_scale, self._emitted = 0.0, emitted_flux(scene.meshes)
        self.cascades = [self._cascade(scene, level) for level in range(len(self.nest.levels))]
        self.border: Border | None = None
        if settings.cascade_light and not self.is_paper and len(self.cascades) > 1:
            self.border = Border(gpu)
        self.seen: SeenBlockers | None = None
        if self.is_paper or settings.surfel_source != "meshes":
            self.seen = SeenBlockers(
                gpu, scene, [part.blockers for part in self.cascades],
                resolution=settings.surfel_resolution, peels=settings.peel_layers,
                keeps=settings.keep_surfels, aspect=size[0] / size[1], is_paper=self.is_paper,
                source=settings.surfel_source,
            )  # fmt: skip
        self._is_first = True
        self._followed: Camera | None = None  # for whom all lattices stand where they should
        self._lit_by: tuple[Any, ...] | None = None

    def outermost(self, scene: Scene) -> Placement:
        """The largest lattice, or the only one."""
        return self.nest.levels[-1]

    @property
    def texture_size(self) -> tuple[int, int, int]:
        """Cells of the textures that the lattices share."""
        return self.nest.texture_size

    @property
    def lattice_count(self) -> int:
        """How many lattices surfaces read."""
        return len(self.nest.levels)

    @property
    def placements(self) -> tuple[Placement, ...]:
        """Where they are, the finest first."""
        return tuple(part.placement for part in self.cascades)

    def _cascade(self, scene: Scene, level: int) -> Cascade:
        gpu, lpv, place = self.gpu, self.lpv, self.nest.levels[level]
        steps = 0 if scene.medium or scene.volumes else lpv.iterations  # air itself turns light
        propagate = Propagate(
            gpu, place, cast(Scheme, lpv.scheme), is_blocked=lpv.occlusion,
            is_reflecting=lpv.bounces, storage=lpv.storage, kept=spread_kept(place.count, steps),
        )  # fmt: skip
        if level == len(self.nest.levels) - 1:
            sky = self.sky.skylight
            return cascade(gpu, place, self.blockers, sky, propagate, self._small(level))
        blockers = Blockers(gpu, scene, self.meshes, place, 0, beside=self.blockers)
        skylight = Skylight(gpu, place, self.lpv.sky_lights, beside=self.sky.skylight)
        return cascade(gpu, place, blockers, skylight, propagate, self._small(level))

    def _small(self, level: int) -> SmallObjects:
        """What a lattice leaves out; the finest nothing, but for what the next one does."""
        cells = [0.0, *(place.cell for place in self.nest.levels[1:]), 0.0]
        if self.lpv.small_objects == "none":
            return EVERYTHING
        return SmallObjects(
            cells[level], cells[level + 1], has_still=self.lpv.small_objects == "all"
        )

    def solve(self, commands: Commands, scene: Scene) -> None:
        """Shadow maps -> inject -> propagate -> textures."""
        if scene.camera != self._followed:
            is_settled = follow(self.nest, self.cascades, scene.camera, is_first=self._is_first)
            self._followed = scene.camera if is_settled else None
            self._is_first = False
        self.placement = self.cascades[-1].placement
        low, high = self._bounds(scene)
        is_open = self.is_paper or scene.medium or scene.volumes or scene.light_groups
        self._hull = EVERYWHERE if is_open else (triple(low), triple(high))
        flux = flux_bound([*scene.lights, *self.sky.lights], low, high) + self._emitted
        flux += self.points.take(scene.light_groups)
        scale, self.power_scale = fixed_point_scale(flux), texture_scale(flux)
        with commands.stage("shadow maps"):
            self.lights.encode(commands, self.meshes, scene.lights, scene.environment, low, high)
        with commands.stage("blockers"):
            moved = self._block(commands, scene, low, high)
        with commands.stage("sky"):
            self._light_sky(commands, scene, moved, scale)
        with commands.stage("reflective shadow maps"):
            self._draw_maps(commands, scene.lights, low, high)
        lit_by = self._lit(scene, scale)
        # A frame whose stages are timed says what each costs.
        if lit_by is None or lit_by != self._lit_by or commands.is_timed:
            self._lit_by = None  # until it is done
            self._fill(commands, scale)
            self._lit_by = self._lit(scene, scale)

    def _lit(self, scene: Scene, scale: float) -> tuple[Any, ...] | None:
        """What the lattices' light depends on; None where they must be filled anyway."""
        if any(part.is_stale for part in self.cascades):
            return None
        places = tuple(replace(part.placement, fade=None) for part in self.cascades)
        # The points are kept while theirs are the groups.
        groups = tuple(map(id, scene.light_groups))
        versions = (self.sun_maps.version, self.lamp_maps.version, self.meshes.version)
        return (*versions, *places, groups, scale, self.power_scale, self._hull, self.lpv)

    def _fill(self, commands: Commands, scale: float) -> None:
        """Inject -> propagate -> textures."""
        with commands.stage("inject"):
            for part in self.cascades:
                if part.is_stale:
                    self._inject_steady(commands, part, scale)
                for maps in (self.sun_maps, self.lamp_maps):
                    if maps.layers:
                        self._inject(commands, part, maps, scale)
                walls = part.blockers.walls
                self.points.encode(commands, part.placement, walls, part.sums, scale)
        # The largest first: what lies beyond the next one's borders.
        for level in range(len(self.cascades) - 1, -1, -1):
            self._propagate(commands, level, scale)

    def _block(self, commands: Commands, scene: Scene, low: Any, high: Any) -> list[bool]:
        """Surfels into the blockers; returns which lattices' changed."""
        if self.seen is None:
            return [part.blockers.encode(commands) for part in self.cascades]
        return self.seen.encode(commands, self.meshes, scene, np.asarray(low), np.asarray(high))

    def _light_sky(self, commands: Commands, scene: Scene, moved: list[bool], scale: float) -> None:
        """The sky's maps and cubes, where light, geometry or a lattice's place changed."""
        changed = self.sky.encode(commands, self.meshes, scene.environment, self.blockers.bound)
        for part, has_moved in zip(self.cascades, moved, strict=True):
            part.is_stale = part.is_stale or changed or has_moved or scale != self._steady_scale
            is_done = changed and part.skylight is self.sky.skylight
            if (changed or has_moved) and not is_done:
                # Seen surfels change where no lattice moved.
                is_same = not changed and self.seen is None
                self.sky.light(commands, part.skylight, part.blockers.bound, is_same_light=is_same)
        self._steady_scale = scale

    def _propagate(self, commands: Commands, level: int, scale: float) -> None:
        part = self.cascades[level]
        with commands.stage("inject"):
            if self.border and level + 1 < len(self.cascades):
                solved = {**self.textures.bound, **self.blockers.bound}
                self.border.encode(
                    commands, part.placement, self.cascades[level + 1].placement, solved,
                    self.linear, self._faces(part), part.sums, power_scale=self.power_scale,
                    scale=scale,
                )  # fmt: skip
            self.resolve.encode(
                commands, part.placement, part.sums, part.steady, part.injected, scale
            )
        with commands.stage("propagate"):
            total = part.propagate.encode(
                commands, part.injected, self._faces(part), self.lpv.iterations,
                has_tail=self.lpv.tail,
            )  # fmt: skip
        with commands.stage("pack"):
            self.textures.encode(
                commands, part.injected, total, self.power_scale, hull=self._hull,
                is_shaped=self._is_shaped, placement=part.placement,
            )  # fmt: skip

    def _faces(self, part: Cascade) -> Buffer:
        """What blocks between the cells of a lattice."""
        return part.blockers.faces

    def _draw_maps(
        self, commands: Commands, lights: tuple[Light, ...], low: Any, high: Any
    ) -> None:
        for group, maps in zip(_by_kind(lights), (self.sun_maps, self.lamp_maps), strict=True):
            if group:
                views = light_views(group, np.asarray(low), np.asarray(high), maps.resolution)
                maps.encode(commands, self.meshes, group, views)

    def _inject(
        self, commands: Commands, part: Cascade, maps: ReflectiveShadowMaps, scale: float
    ) -> None:
        self.inject.encode(
            commands, maps, part.placement, part.blockers.walls, part.sums, scale,
            is_shaped=self._is_shaped, small=part.small,
        )  # fmt: skip

    def _inject_steady(self, commands: Commands, part: Cascade, scale: float) -> None:
        """What sky, geometry and the lattice's place alone change: sky bounce, emission."""
        part.is_stale = False
        if self.sky.maps.layers:
            self._inject(commands, part, self.sky.maps, scale)
        if self.blockers.is_emissive:
            self.emission.encode(
                commands, part.blockers, part.sums, scale, is_shaped=self._is_shaped
            )
        self.resolve.encode(commands, part.placement, part.sums, self.black, part.steady, scale)

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        found = {"lattice": list(self.placement.count), "iterations": self.lpv.iterations}
        if len(self.cascades) > 1:
            places = [part.placement for part in self.cascades]
            found |= {"cascades": [{"cell_m": p.cell, "cells": list(p.count)} for p in places]}
        return found

    def release(self) -> None:
        """Give the memory back."""
        super().release()
        for part in self.cascades:
            part.release()
        for part in self.cascades[:-1]:
            part.blockers.release()
            part.skylight.release()
        if self.seen:
            self.seen.release()
        for shared in (self.points, self.sun_maps, self.lamp_maps):
            shared.release()


def _by_kind(lights: tuple[Light, ...]) -> tuple[list[Light], list[Light]]:
    suns: list[Light] = [x for x in lights if isinstance(x, DirectionalLight)]
    return suns, [x for x in lights if not isinstance(x, DirectionalLight)]
