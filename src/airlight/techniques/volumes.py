"""Volumes in a lattice of reflected light, where solvers of their own draw the volumes.

    reflective shadow maps -> attenuated by the volumes -> injected into the lattice
    cell faces             -> blocked and reflecting where volumes stand (`media.volume_blockers`)
    single scattering      -> injected as well, for a second propagation that surfaces read
    scattered forwards     -> beams, which reach surfaces beside the propagation

The first propagation holds light of surfaces alone. The volumes' solvers take their indirect light
from it, because they already know what the volumes themselves scatter.
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
from ..lattice.irradiance import Irradiance
from ..lattice.lobes import InjectionTarget
from ..lattice.lookup import LatticeStates, LatticeTextures
from ..lpv.cascades import Cascade
from ..lpv.solver import LpvSolver
from ..media.attenuated_maps import AttenuatedMaps, AttenuatedSkyMaps
from ..media.density_grids import ColumnPlan
from ..media.gpu_media import GpuMedia
from ..media.reduced import reduced
from ..media.volume_blockers import VolumeBlockers
from ..scatter.cell_lights import CellLights
from ..scatter.forward_beams import ForwardBeams
from ..scatter.inject_single import InjectSingle
from ..scene.scene import Scene
from ..surface.reflective import ReflectiveShadowMaps


class LatticeVolumes:
    """A scene's volumes as `lpv.lattice_media` has them; on the device they are `media`."""

    def __init__(
        self, solver: LpvSolver, media: GpuMedia, beams: ForwardBeams | None = None
    ) -> None:
        """`beams`: light on surfaces that the media only scatter forwards."""
        self._solver, self._media, self.beams = solver, media, beams
        kit = solver.kit
        gpu, scene = kit.gpu, kit.context.scene
        # Reflective shadow maps, attenuated between their light and each texel: less where light
        # scattered forwards arrives, too.
        self.isotropic = GpuMedia(
            gpu,
            _reduced_isotropic(scene),
            light_count=kit.lights.count,
            columns=ColumnPlan(shared=kit.shared),
        )
        arriving = self.isotropic if beams else media
        self._lights = [
            AttenuatedMaps(gpu, maps, arriving, owners)
            for maps, owners in zip(solver.maps.groups, solver.maps.owners, strict=True)
        ]
        self._sky = AttenuatedSkyMaps(gpu, kit.sky.maps, arriving)
        self._attenuated: dict[int, ReflectiveShadowMaps] = {
            id(maps): own for maps, own in zip(solver.maps.groups, self._lights, strict=True)
        } | {id(kit.sky.maps): self._sky}
        # Faces of each lattice that volumes block.
        self._blockers = [
            VolumeBlockers(gpu, media, part.placement.cells) for part in solver.cascades
        ]
        self._blocked_versions: list[tuple[Any, ...]] = [()] * len(solver.cascades)
        # What reduced isotropic volumes scatter once, and the lattices that it enters.
        self.textures = LatticeTextures(gpu, kit.placement, kit.lattices.texture_size)
        self._inject, self._resolve = InjectSingle(gpu, self.isotropic), Resolve(gpu)
        self._levels = [_Level(gpu, part) for part in solver.cascades]

    def update(self, commands: Commands, frame: Frame) -> None:
        """Update the volumes on the device."""
        with commands.stage("air"):
            self._media.update(commands, frame.scene, *frame.bounds)
            # The lattice's light is isotropic, so reduced media stand for those that are not.
            self.isotropic.update(commands, _reduced_isotropic(frame.scene), *frame.bounds)
        if self.beams is not None:
            self.beams.encode(commands, frame)

    @property
    def version(self) -> int:
        """A number that changes with the volumes."""
        return self._media.version

    def attenuate(self, commands: Commands) -> None:
        """Attenuate the maps of all lights, drawn for this frame, by the volumes."""
        for maps in self._lights:
            maps.attenuate(commands, self._solver.kit.lights.table)

    def attenuate_sky(self, commands: Commands) -> None:
        """Attenuate the sky's maps."""
        self._sky.attenuate(commands)

    def attenuated(self, maps: ReflectiveShadowMaps) -> ReflectiveShadowMaps:
        """The attenuated maps that replace `maps`."""
        return self._attenuated[id(maps)]

    def block(self, commands: Commands, level: int, geometry: int) -> None:
        """Update the blocked faces of a lattice, where volumes or walls changed."""
        part = self._solver.cascades[level]
        # Other faces are closed where the lattice moved, or volumes or walls changed.
        made = (geometry, replace(part.placement, fade=None), self._media.version)
        if made != self._blocked_versions[level]:
            self._blocked_versions[level] = made
            self._blockers[level].encode(commands, part.placement, part.blockers.faces)

    def faces(self, level: int) -> Buffer:
        """What blocks between the cells of a lattice: volumes and walls."""
        return self._blockers[level].faces

    def send(self, commands: Commands, level: int, scale: float) -> None:
        """Propagate the light of surfaces and of volumes once more, into `textures`.

        Volumes send what they scatter once; the faces that they block reflect the rest back into
        the lattice. The coarser lattices come first: at its border a finer one takes in the next
        one's light with the volumes', in place of that of surfaces alone.
        """
        solver, own = self._solver, self._levels[level]
        part, lights = solver.cascades[level], solver.kit.lights
        with commands.stage("inject"):
            # Instead of the larger lattice's light of surfaces, that with the volumes' own.
            base = part.injected
            if solver.border and level + 1 < len(self._levels):
                target = InjectionTarget(part.placement, part.blockers.walls, own.sums, scale)
                solver.enter(commands, level, self.textures, target)
                solver.enter(commands, level, solver.textures, replace(target, scale=-scale))
                self._resolve.encode(
                    commands, part.placement, own.sums, part.injected, own.base, scale
                )
                base = own.base
            # What the volumes scatter for the first time.
            self._inject.encode(
                commands,
                part.placement,
                CellLights(lights.bound, lights.count, part.blockers.walls),
                base=base,
                cells=own.cells,
            )
        with commands.stage("propagate"):
            total = solver.propagated(commands, level, own.cells)
        with commands.stage("pack"):
            self.textures.encode(
                commands,
                LatticeStates(own.cells, total, self.beams.beams(level) if self.beams else None),
                solver.power_scale,
                is_shaped=solver.settings.occlusion,
                placement=part.placement,
            )

    @property
    def forward(self) -> Irradiance | None:
        """Light that volumes only scatter forwards, of which `textures` have it, too."""
        return self.beams.field if self.beams else None


class _Level:
    """The buffers of one lattice."""

    def __init__(self, gpu: Gpu, part: Cascade) -> None:
        nbytes = part.injected.nbytes
        self.cells = Buffer(gpu, "light of volumes", nbytes)
        self.base = Buffer(gpu, "light before volumes", nbytes)
        self.sums = new_sums(gpu, part.placement)


def _reduced_isotropic(scene: Scene) -> Scene:
    """The scene's volumes reduced to isotropic ones, per steradian: the lattice is in W sr^-1."""
    # The lattice holds intensity, W sr^-1, so that isotropic scattering is over 4 pi.
    volumes = []
    for volume in scene.volumes:
        isotropic = reduced(volume)
        r, g, b = (share / (4.0 * math.pi) for share in isotropic.albedo)
        volumes.append(replace(isotropic, albedo=(r, g, b)))
    return replace(scene, volumes=tuple(volumes))
