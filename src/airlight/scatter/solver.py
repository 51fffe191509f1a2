"""Light scattered many times, solved on nested lattices (Billeter2012), the largest first.

cells      reduced media and walls
injection  reflective shadow maps, first-scattered light, the sky -> W per cell
outer      what enters a finer lattice from the larger one around it -> W per cell
states     26 neighbours, over and over -> the sum of all states, its track
fields     irradiance of surfaces, mean radiance in media
"""

from __future__ import annotations

import dataclasses

from ..fields import Fields, Frame, ReflectedLight, Solver
from ..gpu.commands import Commands
from ..gpu.memory import Buffer
from ..lattice.irradiance import Irradiance
from ..lighting.kit import Kit
from ..media.reduced import absorbing_volumes
from ..scene.scene import Scene
from .cascades import Cascade, cascades
from .emission import Emission
from .entering_light import EnteringLight
from .forward_beams import ForwardBeams
from .inject_outer import InjectOuter
from .light_in_air import LightInAir
from .reduced_media import ReducedMedia
from .settings import ScatterSettings
from .surface_beams import SurfaceBeams
from .surface_light import SurfaceLight


class ScatterSolver(Solver):
    """Yields the irradiance of surfaces and the mean radiance that media scatter."""

    may_lag = True

    def __init__(
        self,
        kit: Kit,
        settings: ScatterSettings,
        *,
        has_volumes: bool = True,
        has_border_light: bool = True,
        is_gathered: bool = False,
        beams: ForwardBeams | None = None,
    ) -> None:
        """`has_volumes`: whether the scene's volumes are part of the lattices' medium; else, of
        what other solvers know, the lattices see what it absorbs.

        `has_border_light`: whether finer lattices take in light from beyond their borders.
        `is_gathered`: whether a gather's rays meet its media. `beams`: of all media, where they are
        not all in the lattices. Raises SettingsError where the scheme cannot do the scene's media.
        """
        self.kit, self.has_volumes = kit, has_volumes
        gpu, scene = kit.gpu, self._seen(kit.context.scene)
        self.media = ReducedMedia(kit, scene)
        self.light = EnteringLight(kit, scene, settings, self.media, keeps_light=is_gathered)
        self.cascades = cascades(kit, scene, settings, self.light)
        self._outer: InjectOuter | None = None
        if has_border_light and len(self.cascades) > 1:
            self._outer = InjectOuter(gpu, is_varied=self.largest.cells.is_varied)
        # What surfaces and media read.
        size = kit.lattices.texture_size
        self.emission = Emission(gpu, kit.placement, size)
        self.surfaces = SurfaceLight(gpu, kit.lattices.nest.over_inner, size)
        self.air = LightInAir(gpu, kit) if is_gathered else None
        # Light that media only scatter forwards, apart for rays, which do not meet it.
        self.beams = beams
        self._beams = SurfaceBeams(gpu, kit) if is_gathered and beams is None else None
        self._has_beams = False

    @property
    def largest(self) -> Cascade:
        """The lattice that covers the scene."""
        return self.cascades[-1]

    def _seen(self, scene: Scene) -> Scene:
        """The scene as the lattices see it."""
        return scene if self.has_volumes else absorbing_volumes(scene)

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """Inject what surfaces reflect and media scatter once, propagate, make textures of it.

        Raises SettingsError (scheme paper in a dense medium).
        """
        # Lattices see the media that they solve, beams see all.
        seen = dataclasses.replace(frame, scene=self._seen(frame.scene))
        with commands.stage("air"):
            self.media.update(commands, seen)
        if self.beams is not None:
            self.beams.encode(commands, frame)
        self.light.begin(commands, seen)
        # The largest lattice first: finer ones take in its light at their borders.
        around: tuple[Cascade, Buffer] | None = None
        for part in reversed(self.cascades):
            around = part, self._solved(commands, seen, part, around)
        return self._added(frame.scene, fields)

    def _solved(
        self,
        commands: Commands,
        frame: Frame,
        part: Cascade,
        around: tuple[Cascade, Buffer] | None,
    ) -> Buffer:
        """The sum of all states of a lattice, W, which its textures hold from here on.

        `around`: the larger lattice, with its sum.
        """
        is_new = part.take(commands)
        # What enters it: light that surfaces reflect, and that media scatter for the first time.
        injection = part.injection
        injection.encode(commands, frame, is_new=is_new)
        if self._outer and around:
            with commands.stage("border"):
                self._enter(commands, part, *around)
        # Everything that follows: scattered and reflected again and again.
        with commands.stage("propagate"):
            part.states.schedule = part.plans[frame.is_still]
            total, track = part.states.encode(commands, injection.source)
        # The track becomes mean radiance in media, the states irradiance of surfaces.
        with commands.stage("copy"):
            flux, beams, placement = self.light.flux, injection.beams, part.placement
            self.emission.encode(
                commands, track, flux, beams, sigma_t=self.media.sigma_t, placement=placement
            )
            medium, near = part.cells.surface_medium, injection.surface_beams
            if self.beams is not None:
                near = self.beams.beams(self.cascades.index(part))
            self.surfaces.encode(commands, total, flux, medium, forward=near, placement=placement)
            if self.air is not None:
                self.air.encode(commands, part, track, flux, self.media.sigma_t)
            self._has_beams = near is not None
            if self._beams is not None and near is not None:
                self._beams.encode(commands, near, injection.black, flux, placement)
        return total

    def _enter(self, commands: Commands, part: Cascade, outer: Cascade, total: Buffer) -> None:
        """Add the light to a lattice's source that enters it from the `outer` one, of `total`."""
        assert self._outer is not None
        self._outer.encode(
            commands,
            (part.placement, outer.placement),
            (part.states.medium, outer.states.medium),
            self.kit.blockers.bound,
            outer_sum=total,
            cells=part.injection.source,
            sigma_t=self.media.sigma_t,
        )

    def _added(self, scene: Scene, fields: Fields) -> Fields:
        """The fields, with what was solved."""
        # What surfaces read; then what media scatter, which surfaces also reflect into others.
        placements = self.kit.lattices.placements
        # Of surfaces: their irradiance, by lattice.
        table = self.kit.lattices.table.filled(
            [self.surfaces.params(placement) for placement in placements]
        )
        irradiance = Irradiance({"lattices": table, **self.surfaces.bound}, is_reflected=True)
        # Of media: mean radiance in cells, and light by light what goes forwards.
        has_beams = self.media.has_forward and self.kit.lights.count > 0
        light = self.emission.source(
            self.kit.blockers.bound,
            self.light.forward.source(self.kit.lights.table) if has_beams else None,
            finer=placements[:-1],
            is_reduced_medium=self.media.is_reduced,
        )
        # The same light as media get from surfaces; it changes with whatever lights or blocks.
        version = (scene.lights, scene.environment, self.media.version, self.kit.meshes.version)
        fields = dataclasses.replace(
            fields,
            irradiance=irradiance,
            scattered=light,
            reflected=ReflectedLight(light, version),
            lit=self.light.maps.groups,
        )
        if self.air is None:
            return fields
        forward = self.beams.field if self.beams else None
        if self._beams is not None and self._has_beams:
            forward = self._beams.field
        air = self.air.field(self.kit.blockers.bound)
        return dataclasses.replace(fields, air=air, forward=forward)

    @property
    def stats(self) -> dict[str, object]:
        """What was solved, for --stats."""
        placements = self.kit.lattices.placements
        # Iterations are those of the largest lattice. Who reads them still finds the numbers that
        # multigrid cycles had: one level, no cycle.
        found: dict[str, object] = {
            "lattice": list(self.kit.placement.count),
            "iterations": self.largest.states.schedule.iterations,
            "levels": 1,
            "cycles": 0,
        }
        if len(placements) > 1:
            found["cascades"] = [{"cell_m": p.cell, "cells": list(p.count)} for p in placements]
        return found
