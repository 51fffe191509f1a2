"""Light that any of a scene's media only scatter forwards, on surfaces.

The same beams as `forward` has of a lattice's media, of volumes, too, that are solved on grids of
their own: the optical depths of all media along a light's path add up. Of such a volume the gather
meets what its reduced medium scatters (`fields.Source.mean`), so that all light counts once.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..fields import Fields, Frame, Solver
from ..gpu.commands import Commands
from ..gpu.memory import Buffer
from ..lattice.inject import flux_bound
from ..lattice.irradiance import Irradiance
from ..lattice.lattices import Level
from ..lighting.kit import Kit
from ..media.reduced import AnyMedium, ChangedMedia, is_forward
from ..scene.scene import Scene
from .cell_lights import CellLights
from .forward import ForwardLight
from .near_surfaces import NearSurfaces
from .reduced_media import ReducedMedia
from .sky_table import SkyTable
from .surface_beams import SurfaceBeams

_FRAME_STEP = 2  # of the sky's lights moving frames take one in each cell, neighbours others


class ForwardBeams:
    """Beams in the cells of all lattices of a `kit`, and on surfaces.

    Nothing is made before the first frame whose media scatter forwards.
    """

    def __init__(self, kit: Kit, *, has_solved_medium: bool = False, sky: str = "always") -> None:
        """`has_solved_medium`: the scene's own medium is solved as volumes are. `sky`: which frames
        have its beams, as the setting `gather` has it: off, still, always."""
        self._kit, self._sky = kit, sky
        self._forwards = ChangedMedia(_forwards, has_medium=has_solved_medium)
        self._made: _Made | None = None
        self._has_any = False

    def encode(self, commands: Commands, frame: Frame) -> None:
        """Find the beams of a frame, where anything changed."""
        # Forward lobes alone make beams: media that scatter backwards count as isotropic.
        scene = self._forwards.of(frame.scene)
        self._has_any = is_forward(scene)
        if not self._has_any:
            return
        if self._made is None:
            # Of the scene that all tables of media are made of, whose densities they share.
            self._made = _Made(self._kit, self._kit.context.scene)
        # Moving frames may do without the sky's beams, as they do without the gather.
        has_sky = self._sky == "always" or (self._sky == "still" and frame.is_still)
        self._made.encode(commands, replace(frame, scene=scene), has_sky=has_sky)

    def beams(self, level: int) -> Buffer | None:
        """Of the cells of a lattice, W m; None where no medium scatters forwards."""
        return self._made.levels[level].forward.all if self._made and self._has_any else None

    @property
    def field(self) -> Irradiance | None:
        """On surfaces."""
        return self._made.surfaces.field if self._made and self._has_any else None


class _Made:
    """The passes that find beams, and their results."""

    def __init__(self, kit: Kit, scene: Scene) -> None:
        gpu, self._kit = kit.gpu, kit
        # Media as beams meet them, beams in the cells of each lattice, and on surfaces.
        self._media = ReducedMedia(kit, scene)
        self.levels = [_Level(kit, level, self._media) for level in kit.lattices.levels]
        self.surfaces = SurfaceBeams(gpu, kit)
        largest = max(level.placement.cells for level in kit.lattices.levels)
        self._black = Buffer(gpu, "no forward light", 3 * largest * 16)
        self._sky_table = SkyTable(kit)

    def encode(self, commands: Commands, frame: Frame, *, has_sky: bool) -> None:
        """Find the beams of a frame whose volumes scatter forwards; of its sky if `has_sky`."""
        kit, sky, scene = self._kit, self._kit.sky, frame.scene
        with commands.stage("air"):
            self._media.update(commands, frame)
        self._sky_table.update()
        has_sky = has_sky and self._sky_table.has_any
        # Beams of the sky stay cached while its lights, its maps and its media are the same.
        sky_key: tuple[Any, ...] = ()
        step = 1 if frame.is_still else _FRAME_STEP
        if has_sky:
            sky_key = (self._sky_table.rows, sky.version, self._media.sky.version)
        # Irradiance is stored over the most power that may come in: the key holds that, too.
        flux = flux_bound([*scene.lights, *sky.lights], *frame.bounds)
        key = (scene.lights, self._media.lights.version, flux)
        with commands.stage("single-scattered"):
            for level in self.levels:
                level.near.encode(commands)
                # The sky's lights stay the same for long, the scene's move.
                if has_sky:
                    lights = self._sky_table.cell_lights(level.of.blockers.walls)
                    level.encode_sky(commands, kit, lights, self._black, sky_key, step)
                base = level.forward.sky if has_sky else self._black
                lights = CellLights(kit.lights.bound, len(scene.lights), level.of.blockers.walls)
                if level.encode(commands, kit, lights, base, (*key, step, sky_key)):
                    beams, placement = level.forward.all, level.of.placement
                    self.surfaces.encode(commands, beams, self._black, flux, placement)


class _Level:
    """The beams of one lattice, with what they depend on."""

    def __init__(self, kit: Kit, level: Level, media: ReducedMedia) -> None:
        self.of, self.forward = level, ForwardLight(kit.gpu, level.placement, media)
        self.near = NearSurfaces(kit.gpu, level)
        self._key: tuple[Any, ...] = ()
        self._sky_key: tuple[Any, ...] = ()

    def _walls(self, kit: Kit) -> tuple[Any, ...]:
        """Where the cells are, and the versions of the surfaces around them."""
        placement = replace(self.of.placement, fade=None)
        return placement, kit.meshes.version, self.of.blockers.version

    def encode_sky(
        self,
        commands: Commands,
        kit: Kit,
        lights: CellLights,
        black: Buffer,
        key: tuple[Any, ...],
        step: int,
    ) -> None:
        """The sky's, if the `key` of its light or the walls are others.

        `step`: cells take each so many of its lights.
        """
        key = (key, step, self._walls(kit))
        if key != self._sky_key:
            self._sky_key = key
            self.forward.encode_sky(
                commands, self.of, lights, base=black, near=self.near.cells, light_step=step
            )

    def encode(
        self, commands: Commands, kit: Kit, lights: CellLights, base: Buffer, key: tuple[Any, ...]
    ) -> bool:
        """All, if the `key` of the light or the walls are others; whether they are."""
        key = (key, self._walls(kit))
        if key == self._key:
            return False
        self._key = key
        self.forward.encode(commands, self.of, lights, base=base, near=self.near.cells)
        return True


def _forwards(medium: AnyMedium) -> AnyMedium:
    """One that scatters isotropically where it scatters backwards: what that is reduced to is
    itself then."""
    if min(medium.g) >= 0.0:
        return medium
    r, g, b = (max(c, 0.0) for c in medium.g)
    return replace(medium, g=(r, g, b))


class ForwardSolver(Solver):
    """Yields `forward` and, where nothing else does, `irradiance`."""

    def __init__(self, beams: ForwardBeams) -> None:
        self.beams = beams

    def solve(self, commands: Commands, frame: Frame, fields: Fields) -> Fields:
        """The beams of a frame."""
        self.beams.encode(commands, frame)
        # Where no lattice brings irradiance, that of the beams is all there is.
        forward = self.beams.field
        return replace(fields, forward=forward, irradiance=fields.irradiance or forward)
