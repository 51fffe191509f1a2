"""Light scattered many times, solved on one lattice (Billeter2012).

cells      reduced media and walls
injection  reflective shadow maps, first-scattered light, the sky -> W per cell
levels     26 neighbours, over and over -> the sum of all states, its track
fields     irradiance of surfaces, mean radiance in media
"""

from __future__ import annotations

import dataclasses

from ..fields import Fields, Frame, ReflectedLight, Solver
from ..gpu.commands import Commands
from ..lattice.irradiance import Irradiance
from ..lighting.kit import Kit
from ..lighting.view import View
from ..scene.scene import Scene
from .cells import LatticeCells
from .emission import Emission
from .injection import Injection
from .levels import Levels
from .reduced import reduced_scene
from .schedule import Schedule, cycles_to, iterations_to, schedule
from .settings import ScatterSettings, densest_medium
from .surface_light import SurfaceLight


class ScatterSolver(Solver):
    """Yields the irradiance of surfaces and the mean radiance that media scatter."""

    def __init__(self, kit: Kit, settings: ScatterSettings, *, has_volumes: bool = True) -> None:
        """`has_volumes`: whether the scene's volumes are part of the lattice's medium.

        Raises SettingsError where the scheme cannot do the scene's media.
        """
        self.kit, self.settings, self.has_volumes = kit, settings, has_volumes
        gpu, placement, scene = kit.gpu, kit.placement, self._seen(kit.context.scene)
        self.cells = LatticeCells(kit, scene, settings)
        self.injection = Injection(kit, scene, settings, self.cells)
        plan, kind = self._schedule(reduced_scene(scene)), self.cells.kind(scene)
        self.levels = Levels(gpu, placement.count, placement.cell, plan, kind)
        self.emission = Emission(gpu, placement)
        self.surfaces = SurfaceLight(gpu, placement)

    def _seen(self, scene: Scene) -> Scene:
        """The scene as the lattice sees it."""
        return scene if self.has_volumes else dataclasses.replace(scene, volumes=())

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """Inject what surfaces reflect and media scatter once, propagate, make textures of it.

        Raises SettingsError (scheme paper in a dense medium).
        """
        seen = dataclasses.replace(frame, scene=self._seen(frame.scene))
        # What the lattice's cells hold: the reduced media, and the walls between them.
        with commands.stage("air"):
            is_new = self.cells.take_media(commands, seen, self.levels)
        with commands.stage("prepare blockers"):
            is_new = self.cells.take_walls(commands, self.levels) or is_new
        # What enters it: light that surfaces reflect, and that media scatter for the first time.
        self.injection.encode(commands, seen, is_new=is_new)
        # Everything that follows: scattered and reflected again and again.
        with commands.stage("propagate"):
            total, track = self.levels.encode(commands, self.injection.source)
        # The track becomes mean radiance in media, the states irradiance of surfaces.
        with commands.stage("copy"):
            flux, beams = self.injection.flux, self.injection.beams
            self.emission.encode(commands, track, flux, beams, sigma_t=self.cells.densest)
            medium, near = self.cells.surface_medium, self.injection.surface_beams
            self.surfaces.encode(commands, total, flux, medium, forward=near)
        return self._added(frame.scene, fields)

    def _added(self, scene: Scene, fields: Fields) -> Fields:
        """The fields, with what was solved."""
        # What surfaces read; then what media scatter, which surfaces also reflect into others.
        table = self.kit.lattices.table.filled([self.surfaces.params()])
        irradiance = Irradiance({"lattices": table, **self.surfaces.bound}, is_reflected=True)
        light = self.emission.source(
            self.kit.blockers.bound,
            self.injection.forward_source(),
            is_reduced_medium=self.cells.is_reduced,
        )
        version = (scene.lights, scene.environment, scene.medium, self.kit.meshes.version)
        return dataclasses.replace(
            fields, irradiance=irradiance, scattered=light, reflected=ReflectedLight(light, version)
        )

    def solve_view(self, commands: Commands, view: View, fields: Fields) -> Fields:
        """The lattice does not depend on the eye."""
        return fields

    def _schedule(self, reduced: Scene) -> Schedule:
        s, count = self.settings, self.kit.placement.count
        # The paper has one lattice.
        faster = "none" if s.scheme.startswith("paper") else s.acceleration
        # As many iterations as were asked for, or as leave the residual that was.
        steps = s.iterations
        sigma_s, sigma_t = densest_medium(reduced)
        if s.residual > 0.0 and faster == "cycle":
            steps = cycles_to(s.residual)
        elif s.residual > 0.0:
            steps = iterations_to(s.residual, sigma_s, sigma_t, self.kit.placement.cell, count)
        plan = schedule(faster, steps, count)
        if any(sigma_t):
            return plan
        # Without a medium the light of area lights is too bright; converged, it would be more so.
        return dataclasses.replace(plan, cycles=max(1, 2 * plan.cycles // 3), is_rescaled=False)

    @property
    def stats(self) -> dict[str, object]:
        """What was solved, for --stats."""
        plan = self.levels.schedule
        return {
            "lattice": list(self.kit.placement.count),
            "iterations": plan.iterations,
            "levels": len(self.levels.levels),
            "cycles": plan.cycles,
        }
