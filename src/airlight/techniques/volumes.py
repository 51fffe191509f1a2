"""Volumes in a lattice of reflected light, where solvers of their own draw them.

Volumes attenuate the lights that the lattice starts from, stop and turn back what it carries
(`media.volume_blockers`), and send their own first-scattered light to the surfaces: a second
propagation, from the same light and theirs. Volumes take reflected light from the first: what they
scatter themselves their solvers know.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from ..fields import Frame
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..lattice.inject import Resolve, new_sums
from ..lattice.lobes import InjectionTarget
from ..lattice.lookup import LatticeTextures
from ..lpv.cascades import Cascade
from ..lpv.solver import LpvSolver
from ..media.attenuated_maps import AttenuatedMaps, AttenuatedSkyMaps
from ..media.gpu_media import GpuMedia
from ..media.volume_blockers import VolumeBlockers
from ..scatter.inject_single import InjectSingle
from ..scatter.reduced import reduced
from ..scene.scene import Scene
from ..surface.reflective import ReflectiveShadowMaps


class LatticeVolumes:
    """The `lpv.solver.LatticeMedia` of a scene's volumes, all of them on the device in `air`."""

    def __init__(self, solver: LpvSolver, air: GpuMedia) -> None:
        self._solver, self._air = solver, air
        kit = solver.kit
        gpu, scene = kit.gpu, kit.context.scene
        # Lights as they come through the volumes.
        self._lights = [
            AttenuatedMaps(gpu, maps, air, owners)
            for maps, owners in zip(solver.maps.groups, solver.maps.owners, strict=True)
        ]
        self._sky = AttenuatedSkyMaps(gpu, kit.sky.maps, air)
        self._seen: dict[int, ReflectiveShadowMaps] = {
            id(maps): dimmed for maps, dimmed in zip(solver.maps.groups, self._lights, strict=True)
        } | {id(kit.sky.maps): self._sky}
        # Volumes as blockers.
        self._faced = [VolumeBlockers(gpu, air, part.placement.cells) for part in solver.cascades]
        self._faced_of: list[tuple[Any, ...]] = [()] * len(solver.cascades)
        # Their own light: as much as they scatter once, evenly to all sides.
        self.even = GpuMedia(gpu, _evenly(scene), light_count=kit.lights.count)
        self.textures = LatticeTextures(gpu, kit.placement, kit.lattices.texture_size)
        self._inject, self._resolve = InjectSingle(gpu, self.even), Resolve(gpu)
        self._levels = [_Level(gpu, part) for part in solver.cascades]

    def update(self, commands: Commands, frame: Frame) -> None:
        """Take the volumes as they are."""
        with commands.stage("air"):
            self._air.update(commands, frame.scene, *frame.bounds)
            self.even.update(commands, _evenly(frame.scene), *frame.bounds)

    @property
    def version(self) -> int:
        """Another one whenever the volumes changed."""
        return self._air.version

    def attenuate(self, commands: Commands) -> None:
        """The lights' maps, drawn for this frame, as seen through the volumes."""
        for maps in self._lights:
            maps.attenuate(commands, self._solver.kit.lights.table)

    def attenuate_sky(self, commands: Commands) -> None:
        """The sky's maps likewise."""
        self._sky.attenuate(commands)

    def seen(self, maps: ReflectiveShadowMaps) -> ReflectiveShadowMaps:
        """The attenuated ones in place of `maps`."""
        return self._seen[id(maps)]

    def block(self, commands: Commands, level: int, geometry: int) -> None:
        """Volumes and walls as blockers of a lattice, where one of them changed."""
        part = self._solver.cascades[level]
        made = (geometry, replace(part.placement, fade=None), self._air.version)
        if made != self._faced_of[level]:
            self._faced_of[level] = made
            self._faced[level].encode(commands, part.placement, part.blockers.faces)

    def faces(self, level: int) -> Buffer:
        """What blocks between the cells of a lattice, volumes and walls."""
        return self._faced[level].faces

    def send(self, commands: Commands, solver: LpvSolver, level: int, scale: float) -> None:
        """What volumes scatter once onto surfaces, with all that bounced, into `textures`.

        What they scatter more than once, the lattice's own turning back makes of it. A finer
        lattice takes in volumes' light from the next one's, in place of what that has of surfaces
        alone; the larger ones come first.
        """
        part, own, lights = solver.cascades[level], self._levels[level], solver.kit.lights
        with commands.stage("inject"):
            base = part.injected
            if solver.border and level + 1 < len(self._levels):
                target = InjectionTarget(part.placement, part.blockers.walls, own.sums, scale)
                solver.enter(commands, level, self.textures, target)
                solver.enter(commands, level, solver.textures, replace(target, scale=-scale))
                self._resolve.encode(
                    commands, part.placement, own.sums, part.injected, own.base, scale
                )
                base = own.base
            self._inject.encode(
                commands,
                part.placement,
                lights.bound,
                lights.count,
                walls=part.blockers.walls,
                base=base,
                cells=own.cells,
            )
        with commands.stage("propagate"):
            total = solver.propagated(commands, level, own.cells)
        with commands.stage("pack"):
            self.textures.encode(
                commands,
                own.cells,
                total,
                solver.power_scale,
                is_shaped=solver.settings.occlusion,
                placement=part.placement,
            )


class _Level:
    """The buffers of one lattice."""

    def __init__(self, gpu: Gpu, part: Cascade) -> None:
        nbytes = part.injected.nbytes
        self.cells = Buffer(gpu, "light of volumes", nbytes)
        self.base = Buffer(gpu, "light before volumes", nbytes)
        self.sums = new_sums(gpu, part.placement)


def _evenly(scene: Scene) -> Scene:
    """Volumes that scatter evenly, and per steradian: the lattice keeps W sr^-1."""
    volumes = []
    for volume in scene.volumes:
        even = reduced(volume)
        r, g, b = (share / (4.0 * math.pi) for share in even.albedo)
        volumes.append(replace(even, albedo=(r, g, b)))
    return replace(scene, volumes=tuple(volumes))
