"""Volumes in a lattice of reflected light, where solvers of their own draw the volumes.

    reflective shadow maps -> attenuated by the volumes -> injected into the lattice
    cell faces             -> blocked and reflecting where volumes stand (`media.volume_blockers`)
    single scattering      -> injected as well, for the propagation that surfaces read
    scattered forwards     -> beams, which reach surfaces beside the propagation

The volumes' solvers already know what the volumes scatter, and what walls inside and close to them
send back of that. So they read the same propagation less another one, of the light of volumes alone
among the walls that they know, with all others black: what surfaces send, and send back.
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
from ..lpv.less import Less
from ..lpv.solver import LpvSolver
from ..media.attenuated_maps import AttenuatedMaps, AttenuatedSkyMaps
from ..media.density_grids import ColumnPlan
from ..media.gpu_media import GpuMedia
from ..media.reduced import reduced
from ..media.volume_blockers import VolumeBlockers
from ..pop.medium.kinds import GridPlan
from ..pop.medium.known_walls import known_walls
from ..pop.settings import PopSettings
from ..scatter.cell_lights import CellLights
from ..scatter.forward_beams import ForwardBeams
from ..scatter.inject_single import InjectSingle
from ..scene.scene import Scene
from ..surface.reflective import ReflectiveShadowMaps


class LatticeVolumes:
    """A scene's volumes as `lpv.lattice_media` has them; on the device they are `media`."""

    def __init__(
        self,
        solver: LpvSolver,
        media: GpuMedia,
        plan: GridPlan,
        settings: PopSettings,
        beams: ForwardBeams | None = None,
    ) -> None:
        """`plan`, `settings`: the grids on which they are solved. `beams`: light on surfaces that
        the media only scatter forwards."""
        self._solver, self._media, self.beams = solver, media, beams
        self._plan, self._settings = plan, settings
        self._scene = solver.kit.context.scene
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
        self._less = Less(gpu)
        self._levels = [_Level(gpu, part) for part in solver.cascades]

    def update(self, commands: Commands, frame: Frame) -> None:
        """Update the volumes on the device."""
        self._scene = frame.scene
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
            # A wall is at most half a cell from the face that it closes.
            margin_m = 0.5 * part.placement.cell
            boxes = known_walls(self._scene.volumes, self._plan, self._settings, margin_m)
            self._blockers[level].encode(commands, part.placement, part.blockers.faces, boxes)

    def faces(self, level: int) -> Buffer:
        """What blocks between the cells of a lattice: volumes and walls."""
        return self._blockers[level].faces

    def send(self, commands: Commands, level: int, scale: float) -> None:
        """Propagate the light of surfaces and of volumes for surfaces, and less of it for volumes.

        Surfaces read all of it, volumes all but what their own solvers know.
        Volumes send what they scatter once; the faces that they block reflect the rest back into
        the lattice. The coarser lattices come first: at its border a finer one takes in the next
        one's light with the volumes', in place of that without what volumes know.
        """
        solver, own = self._solver, self._levels[level]
        part, lights = solver.cascades[level], solver.kit.lights
        with commands.stage("inject"):
            # Instead of what volumes read of the larger lattice's light, all of it.
            base = part.injected
            if solver.border and level + 1 < len(self._levels):
                target = InjectionTarget(part.placement, part.blockers.walls, own.sums, scale)
                solver.enter(commands, level, self.textures, target)
                solver.enter(commands, level, solver.textures, replace(target, scale=-scale))
                self._resolve.encode(
                    commands, part.placement, own.sums, part.injected, own.spare, scale
                )
                base = own.spare
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
            light = LatticeStates(own.cells, total, self.beams.beams(level) if self.beams else None)
        self._pack(commands, level, self.textures, light)
        self._leave_unknown(commands, level, total)

    def _leave_unknown(self, commands: Commands, level: int, total: Buffer) -> None:
        """Fill the textures that volumes read: light of surfaces, with what they send back.

        It is all light, `total`, less that of volumes among the walls that they know.
        """
        solver, own = self._solver, self._levels[level]
        part = solver.cascades[level]
        with commands.stage("propagate"):
            # The paper's steps clamp, so that no light can be taken from other light.
            if solver.is_paper:
                rest = solver.propagated(commands, level, part.injected)
            else:
                rest = own.rest
                commands.encoder.copy_buffer_to_buffer(total.handle, 0, rest.handle, 0, rest.nbytes)
                self._less.encode(commands, own.cells, part.injected, own.spare)
                known = self._blockers[level].known_faces
                own_light = solver.propagated(commands, level, own.spare, known)
                self._less.encode(commands, rest, own_light, own.spare)
                rest = own.spare
        self._pack(commands, level, solver.textures, LatticeStates(part.injected, rest))

    def _pack(
        self, commands: Commands, level: int, textures: LatticeTextures, light: LatticeStates
    ) -> None:
        """Fill the part of `textures` that a lattice has."""
        solver = self._solver
        with commands.stage("pack"):
            textures.encode(
                commands,
                light,
                solver.power_scale,
                is_shaped=solver.lobe.is_shaped,
                placement=solver.cascades[level].placement,
            )

    @property
    def forward(self) -> Irradiance | None:
        """Light that volumes only scatter forwards, of which `textures` have it, too."""
        return self.beams.field if self.beams else None


class _Level:
    """The buffers of one lattice."""

    def __init__(self, gpu: Gpu, part: Cascade) -> None:
        nbytes = part.injected.nbytes
        self.cells = Buffer(gpu, "light with that of volumes", nbytes)
        self.rest = Buffer(gpu, "propagated light with that of volumes", nbytes)
        self.spare = Buffer(gpu, "light before volumes, and without what they know", nbytes)
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
