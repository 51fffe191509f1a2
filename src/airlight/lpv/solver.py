"""Indirect light on nested lattices (Kaplanyan2010), top to bottom.

reflective shadow maps -> virtual point lights -> cells -> propagation -> irradiance

Volumes in the lattice take part by `LatticeMedia`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..fields import Fields, Frame, LatticeSource, ReflectedLight, Solver
from ..gpu.commands import Commands
from ..gpu.memory import Buffer, linear_sampler
from ..lattice.inject import Inject, Resolve, fixed_point_scale, flux_bound
from ..lattice.irradiance import Irradiance
from ..lattice.lobes import COSINE, SHAPED, InjectionTarget
from ..lattice.lookup import LatticeStates, LatticeTextures, texture_scale
from ..lattice.placement import EVERYWHERE, Hull, LatticeParams
from ..lattice.point_lights import InjectPoints
from ..lighting.kit import Kit
from ..maths.lattice6 import LOOKUP_SCALE, enough_steps
from ..scene.scene import Scene
from ..surface.light_maps import BLOCK, LightMaps
from ..surface.reflective import ReflectiveShadowMaps
from .border import Border
from .cascades import Cascade, cascades
from .lattice_media import LatticeMedia
from .seen_blockers import SeenBlockers
from .settings import LpvSettings


class LpvSolver(Solver):
    """Yields the irradiance of surfaces, and the light that they reflect into media."""

    may_lag = True

    def __init__(self, kit: Kit, settings: LpvSettings, *, is_marched: bool = False) -> None:
        """`is_marched`: whether media scatter it towards the eye (Billeter2012, Fig. 5)."""
        self.kit, self.settings, self.is_marched = kit, settings, is_marched
        gpu, scene = kit.gpu, kit.context.scene

        # Steps enough for the lattice with the most cells across.
        self.steps = settings.iterations or max(
            enough_steps(placement.count) for placement in kit.lattices.nest.levels
        )
        self.is_paper = settings.scheme == "paper"
        # Where blockers act from the first step on, a virtual point light may be narrower than a
        # cosine lobe; the paper ignores them in that step.
        self.lobe = SHAPED if settings.occlusion and not self.is_paper else COSINE
        self.media: LatticeMedia | None = None
        # What puts light into cells.
        self.inject, self.resolve = Inject(gpu), Resolve(gpu)
        self.points = InjectPoints(gpu)
        self.linear = linear_sampler(gpu)
        # Light: reflective shadow maps, lattices of cells, the textures that surfaces read.
        self.maps = LightMaps(gpu, scene.lights, settings.map_resolution, block=BLOCK)
        self.cascades = cascades(kit, settings, self.steps)
        self.textures = LatticeTextures(gpu, kit.placement, kit.lattices.texture_size)
        largest = max(part.placement.cells for part in self.cascades)
        self.black = Buffer(gpu, "no light", 3 * largest * 16)

        # Finer lattices take in light of larger ones at their borders, but the paper's do not.
        self.border: Border | None = None
        if settings.cascade_light and not self.is_paper and len(self.cascades) > 1:
            self.border = Border(gpu)
        if self.is_paper or settings.surfel_source != "meshes":
            kit.lattices.source = SeenBlockers(kit, settings)
        # State of the last frame.
        self.power_scale, self._static_scale = 1.0, 0.0
        self._hull: Hull = EVERYWHERE
        self._sky_version = self._media_version = -1
        self._lit_by: tuple[Any, ...] | None = None

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """Solve all lattices where anything changed: maps -> cells -> propagation -> textures."""
        scene = frame.scene
        if self.media:
            self.media.update(commands, frame)
        # Light beyond the hull of all surfaces is lost, where nothing else could return it.
        is_open = self.is_paper or scene.medium or scene.volumes or scene.light_groups
        self._hull = EVERYWHERE if is_open else self.kit.hull(*frame.bounds)
        # Fixed-point sums have to hold all the flux of the lights.
        flux = flux_bound([*scene.lights, *self.kit.sky.lights], *frame.bounds)
        flux += self.points.take(scene.light_groups)
        scale, self.power_scale = fixed_point_scale(flux), texture_scale(flux)
        self._find_stale(commands, scale)
        # The reflective shadow maps of the lights.
        with commands.stage("reflective shadow maps"):
            self.maps.encode(commands, self.kit.meshes, scene.lights, *frame.bounds)
            if self.media:
                self.media.attenuate(commands)
        # The lattices are filled where their light depends on anything else than in the last
        # frame; and in a frame whose stages are timed, which tells what each costs.
        lit_by = self._lit(scene, scale)
        if lit_by is None or lit_by != self._lit_by or commands.is_timed:
            self._lit_by = None  # if it breaks off, the next frame fills them again
            self._fill(commands, scale)
            self._lit_by = self._lit(scene, scale)
        return self._added(frame, fields)

    def _find_stale(self, commands: Commands, scale: float) -> None:
        """Mark the lattices whose static light is of another sky, geometry, scale or medium."""
        # Static light is stored as long as all that it depends on stays.
        sky, media = self.kit.sky.version, self.media.version if self.media else -1
        is_all = sky != self._sky_version or scale != self._static_scale
        is_all = is_all or media != self._media_version
        self._sky_version, self._static_scale, self._media_version = sky, scale, media
        # A lattice stays stale until it is filled again, whichever frame finds it so.
        for part in self.cascades:
            version = part.blockers.version
            part.is_stale = part.is_stale or is_all or version != part.blocked
            part.blocked = version
        if self.media and any(part.is_stale for part in self.cascades):
            with commands.stage("sky"):
                self.media.attenuate_sky(commands)

    def _lit(self, scene: Scene, scale: float) -> tuple[Any, ...] | None:
        """All that the lattices' light depends on; None where they must be filled anyway."""
        if self.media or any(part.is_stale for part in self.cascades):
            return None

        # Fading borders change what is read, not the light itself.
        placements = tuple(replace(part.placement, fade=None) for part in self.cascades)
        # Groups are compared by identity: `points` holds on to them.
        groups = tuple(map(id, scene.light_groups))
        versions = (*self.maps.version, self.kit.meshes.version)
        return (*versions, *placements, groups, scale, self.power_scale, self._hull, self.steps)

    def _fill(self, commands: Commands, scale: float) -> None:
        """Fill all lattices: inject -> propagate -> textures."""
        # Virtual point lights of all maps into the cells of each lattice.
        with commands.stage("inject"):
            for part in self.cascades:
                if part.is_stale:
                    self._inject_static(commands, part, scale)
                for maps in self.maps.groups:
                    if maps.layers:
                        self._inject(commands, part, maps, scale)
                self.points.encode(commands, part.target(scale))
        # The largest lattice first: finer ones take in its light at their borders.
        for level in range(len(self.cascades) - 1, -1, -1):
            self._propagate(commands, level, scale)

    def _inject(
        self, commands: Commands, part: Cascade, maps: ReflectiveShadowMaps, scale: float
    ) -> None:
        self.inject.encode(
            commands,
            self.media.attenuated(maps) if self.media else maps,
            part.target(scale),
            self.lobe,
            small=part.small,
        )

    def _inject_static(self, commands: Commands, part: Cascade, scale: float) -> None:
        """Inject the light of the sky's maps, which is stored until they change."""
        part.is_stale = False
        if self.kit.sky.maps.layers:
            self._inject(commands, part, self.kit.sky.maps, scale)
        self.resolve.encode(commands, part.placement, part.sums, self.black, part.static, scale)

    def _propagate(self, commands: Commands, level: int, scale: float) -> None:
        """Solve one lattice, from the injected light to its textures."""
        part = self.cascades[level]
        if self.media:
            with commands.stage("blockers"):
                self.media.block(commands, level, self.kit.meshes.version)
        # Light that enters from the larger lattice; then the injected states, out of all sums.
        with commands.stage("inject"):
            if self.border and level + 1 < len(self.cascades):
                self.enter(commands, level, self.textures, part.target(scale))
            self.resolve.encode(
                commands, part.placement, part.sums, part.static, part.injected, scale
            )
        # What media send goes through the lattice together with what surfaces do.
        if self.media:
            self.media.send(commands, level, scale)
            return
        # Steps between cells; injected light and theirs are what surfaces read.
        with commands.stage("propagate"):
            total = self.propagated(commands, level, part.injected)
        with commands.stage("pack"):
            self.textures.encode(
                commands,
                LatticeStates(part.injected, total),
                self.power_scale,
                hull=self._hull,
                is_shaped=self.lobe.is_shaped,
                placement=part.placement,
            )

    def propagated(
        self, commands: Commands, level: int, injected: Buffer, faces: Buffer | None = None
    ) -> Buffer:
        """The sum of all propagation steps from the `injected` states of a lattice.

        `faces`: what blocks between its cells, else all that does. The next call overwrites it.
        """
        part = self.cascades[level]
        return part.propagate.encode(
            commands,
            injected,
            faces or self.faces(level),
            self.steps,
            has_tail=self.settings.tail,
        )

    def enter(
        self, commands: Commands, level: int, solved: LatticeTextures, target: InjectionTarget
    ) -> None:
        """Add the light to a lattice that enters it from the larger one, `solved` before."""
        assert self.border is not None
        self.border.encode(
            commands,
            target,
            self.cascades[level + 1].placement,
            {**solved.bound, **self.kit.blockers.bound, "linear_clamp": self.linear},
            self.faces(level),
            power_scale=self.power_scale,
        )

    def faces(self, level: int) -> Buffer:
        """The faces between the cells of a lattice, with all that blocks."""
        return self.media.faces(level) if self.media else self.cascades[level].blockers.faces

    def _added(self, frame: Frame, fields: Fields) -> Fields:
        """The fields, with irradiance, reflected and perhaps scattered light."""
        # What surfaces read, and the same light as media take it.
        textures = self.media.textures if self.media else self.textures
        irradiance = Irradiance(
            {"lattices": self.kit.lattices.table.filled(self.rows), **textures.bound},
            is_reflected=not self.is_paper,
            has_interreflection=self.settings.bounces,
            damping=self.settings.damping,
        )
        # As media take it: the mean over all directions.
        light = self.mean_radiance()
        scene = frame.scene
        version = (scene.lights, scene.environment, scene.medium, self.kit.meshes.version)
        reflected = ReflectedLight(light, version, knows_media=self.media is not None)
        return replace(
            fields,
            irradiance=irradiance,
            reflected=reflected,
            lit=self.maps.groups,
            forward=self.media.forward if self.media else None,
            scattered=light if self.is_marched else fields.scattered,
        )

    @property
    def rows(self) -> list[LatticeParams]:
        """The lattices as shaders read them, the finest first."""
        return [
            part.placement.params(self.power_scale, is_paper=self.is_paper)
            for part in self.cascades
        ]

    def mean_radiance(self) -> LatticeSource:
        """The light that surfaces reflect, as media take it: its mean over all directions."""
        # Power through a cell's face to radiance, in the cells of the largest lattice.
        placement = self.cascades[-1].placement
        scale = LOOKUP_SCALE / (placement.cell**2 * self.power_scale)
        bound = {**self.textures.bound, **self.kit.blockers.bound}
        finer = tuple(part.placement for part in self.cascades[:-1])
        return LatticeSource(placement, bound, scale, finer=finer)

    @property
    def stats(self) -> dict[str, Any]:
        """The lattice's cells and the number of steps, for --stats."""
        placements = [part.placement for part in self.cascades]
        found = {"lattice": list(placements[-1].count), "iterations": self.steps}
        if len(placements) > 1:
            found["cascades"] = [{"cell_m": p.cell, "cells": list(p.count)} for p in placements]
        return found
