"""Bounced light on a lattice among volumes that solvers of their own draw.

The lattice carries what surfaces reflect. Volumes dim the lights that it starts from, stop and
turn back what it carries (`march.faced_air`), and send their own first-scattered light to the
surfaces: a second propagation, from the same light and theirs. Volumes take their bounced light
from the first: what they scatter themselves their solvers know.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..lattice.inject import Resolve, new_sums
from ..lattice.lookup import LatticeTextures
from ..lpv.cascades import Cascade
from ..lpv.lpv import Lpv
from ..march.air import Air
from ..march.dimmed import DimmedMaps, DimmedSky, owners_of
from ..march.faced_air import FacedAir
from ..march.march import LatticeSource
from ..scatter.inject_single import InjectSingle
from ..scatter.similar import similar
from ..scene.lights import DirectionalLight, Light
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from ..surface.reflective import ReflectiveShadowMaps
from .air import InAir, LpvMarchSettings, bounced_light


class LpvWithVolumes(InAir, Lpv):
    """Bounced light on a lattice, dimmed and turned back by volumes, seen through them."""

    Settings = LpvMarchSettings
    volumes_in_lattice = True

    def __init__(
        self, gpu: Gpu, scene: Scene, meshes: GpuScene, settings: LpvMarchSettings,
        size: tuple[int, int],
    ) -> None:  # fmt: skip
        super().__init__(gpu, scene, meshes, settings, size)
        suns = [light for light in scene.lights if isinstance(light, DirectionalLight)]
        lamps = [light for light in scene.lights if not isinstance(light, DirectionalLight)]
        self._dimmed = {
            id(maps): DimmedMaps(gpu, maps, self.air_light.air, owners_of(scene.lights, group))
            for maps, group in ((self.sun_maps, suns), (self.lamp_maps, lamps))
        }
        self._dimmed_sky = DimmedSky(gpu, self.sky.maps, self.air_light.air)
        self._sky_air_version = -1
        self._faced = [
            FacedAir(gpu, self.air_light.air, part.placement.cells) for part in self.cascades
        ]
        self._faced_of: list[tuple[Any, ...]] = [()] * len(self.cascades)
        self._shine = Shine(gpu, scene, self)

    def bounced_source(self) -> LatticeSource | None:
        """In-scattered radiance from the fluence of what surfaces reflect."""
        return bounced_light(self)

    def solve(self, commands: Commands, scene: Scene) -> None:
        """The air first: it dims what the lattice is lit by."""
        with commands.stage("air"):
            self.air_light.air.update(commands, scene, *self._bounds(scene))
            self._shine.air.update(commands, _evenly(scene), *self._bounds(scene))
        super().solve(commands, scene)

    @property
    def lattice_bound(self) -> dict[str, Any]:
        """What surfaces take light from: of surfaces and of volumes."""
        return {**super().lattice_bound, **self._shine.textures.bound}

    def _lit(self, scene: Scene, scale: float) -> tuple[Any, ...] | None:
        """The air has its say wherever light is on its way."""
        return None

    def _draw_maps(
        self, commands: Commands, lights: tuple[Light, ...], low: Any, high: Any
    ) -> None:
        super()._draw_maps(commands, lights, low, high)
        for maps in self._dimmed.values():
            maps.dim(commands, self.lights.table)

    def _light_sky(self, commands: Commands, scene: Scene, moved: list[bool], scale: float) -> None:
        """The sky bounces anew where the air changed."""
        super()._light_sky(commands, scene, moved, scale)
        if self._sky_air_version != self.air_light.air.version:
            self._sky_air_version = self.air_light.air.version
            for part in self.cascades:
                part.is_stale = True
        if any(part.is_stale for part in self.cascades):
            self._dimmed_sky.dim(commands)

    def _inject(
        self, commands: Commands, part: Cascade, maps: ReflectiveShadowMaps, scale: float
    ) -> None:
        if maps is self.sky.maps:
            super()._inject(commands, part, self._dimmed_sky, scale)
            return
        super()._inject(commands, part, self._dimmed.get(id(maps), maps), scale)

    def _propagate(self, commands: Commands, level: int, scale: float) -> None:
        part = self.cascades[level]
        made = (self.meshes.version, replace(part.placement, fade=None), self.air_light.air.version)
        if made != self._faced_of[level]:
            self._faced_of[level] = made
            with commands.stage("blockers"):
                self._faced[level].encode(commands, part.placement, part.blockers.faces)
        super()._propagate(commands, level, scale)
        self._shine.encode(commands, self, level, scale)

    def faces_of(self, part: Cascade) -> Buffer:
        """What blocks between the cells of a lattice, air and walls."""
        return self._faces(part)

    def _faces(self, part: Cascade) -> Buffer:
        return self._faced[self.cascades.index(part)].faces

    def release(self) -> None:
        """Give the memory back."""
        super().release()
        for maps in self._dimmed.values():
            maps.release()
        for faced in self._faced:
            faced.release()
        self._shine.release()
        self._dimmed_sky.release()


class Shine:
    """What volumes scatter once onto surfaces, with all that bounced: `textures`.

    What they scatter more than once, the lattice's own turning back makes of it. A finer lattice
    takes in volumes' light from the next one's, in place of what that has of surfaces alone.
    """

    def __init__(self, gpu: Gpu, scene: Scene, technique: LpvWithVolumes) -> None:
        self.air = Air(gpu, _evenly(scene), light_count=technique.lights.count)
        self.textures = LatticeTextures(gpu, technique.placement, technique.texture_size)
        self._inject, self._resolve = InjectSingle(gpu, self.air), Resolve(gpu)
        self._levels = [_Level(gpu, part) for part in technique.cascades]

    def encode(
        self, commands: Commands, technique: LpvWithVolumes, level: int, scale: float
    ) -> None:
        """After the lattice of surfaces alone was solved; the larger ones first."""
        part, own = technique.cascades[level], self._levels[level]
        faces = technique.faces_of(part)
        with commands.stage("inject"):
            base = part.injected
            if technique.border and level + 1 < len(self._levels):
                self._enter(commands, technique, level, scale)
                base = own.base
            self._inject.encode(
                commands, part.placement, technique.lights.bound, technique.lights.count,
                walls=part.blockers.walls, base=base, cells=own.cells,
            )  # fmt: skip
        with commands.stage("propagate"):
            total = part.propagate.encode(
                commands, own.cells, faces, technique.lpv.iterations, has_tail=technique.lpv.tail
            )
        with commands.stage("pack"):
            self.textures.encode(
                commands, own.cells, total, technique.power_scale,
                is_shaped=technique.lpv.occlusion, placement=part.placement,
            )  # fmt: skip

    def _enter(
        self, commands: Commands, technique: LpvWithVolumes, level: int, scale: float
    ) -> None:
        """`base`: what is put into a lattice; at its borders the next one's light with volumes."""
        part, own = technique.cascades[level], self._levels[level]
        outer = technique.cascades[level + 1].placement
        assert technique.border is not None
        for textures, sign in ((self.textures, 1.0), (technique.textures, -1.0)):
            solved = {**textures.bound, **technique.blockers.bound}
            technique.border.encode(
                commands, part.placement, outer, solved, technique.linear,
                technique.faces_of(part), own.sums, power_scale=technique.power_scale,
                scale=sign * scale,
            )  # fmt: skip
        self._resolve.encode(commands, part.placement, own.sums, part.injected, own.base, scale)

    def release(self) -> None:
        """Give the memory back."""
        self.air.release()
        self.textures.release()
        for level in self._levels:
            level.release()


class _Level:
    """The buffers of one lattice."""

    def __init__(self, gpu: Gpu, part: Cascade) -> None:
        nbytes = part.injected.nbytes
        self.cells = Buffer(gpu, "light of volumes", nbytes)
        self.base = Buffer(gpu, "light before volumes", nbytes)
        self.sums = new_sums(gpu, part.placement)

    def release(self) -> None:
        """Give the memory back."""
        for buffer in (self.cells, self.base, self.sums):
            buffer.release()


def _evenly(scene: Scene) -> Scene:
    """Volumes that scatter evenly, and per steradian: the lattice keeps W sr^-1."""
    volumes = []
    for volume in scene.volumes:
        even = similar(volume)
        r, g, b = (share / (4.0 * math.pi) for share in even.albedo)
        volumes.append(replace(even, albedo=(r, g, b)))
    return replace(scene, volumes=tuple(volumes))
