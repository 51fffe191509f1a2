"""One scattering medium under sun, sky and lamps: the technique, top to bottom (Elek2014).

Light is cut into ordinates, a beam each; every cell marches towards all of them, what leaves the
beams spreads by diffusion, and for every eye each cell is told what it scatters towards it. Nothing
is precomputed; what did not change since the last lit is not done again.

Several media of a scene have a solver each, which shade and light one another; see `together`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..fields import ReflectedLight, Source
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..maths.ordinates import even_sky
from ..maths.transforms import F64
from ..scene.environment import Environment
from ..scene.lights import Light, PointLight
from ..scene.volume import Volume
from .delta.emission import Emission
from .indirect import Bounce
from .light.importance import Look, ViewImportance
from .light.ordinates import SceneOrdinates, even_light, lamps_of
from .light.sky_correction import SkyLight
from .light.visibility import Surfaces
from .medium.grid_medium import GridMedium
from .medium.mixture import Mix
from .schemes import Beams, HoppingBeams
from .settings import PopSettings

_DARK = PointLight((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
_WHITE = (1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Illumination:
    """What media are lit by and seen from; see `PopSolver.encode`."""

    lights: tuple[Light, ...]
    environment: Environment | None
    eye: F64
    surfaces: Surfaces | None = None
    bounced: ReflectedLight | None = None
    look: Look | None = None


class PopSolver:
    """The light that one volume scatters: `medium` is the volume on its grid, `beams` the light.

    The grid's size and the most lights are fixed. `lights`: how many there can be beside the
    environment. `voxels`: the volume's density as a filterable 3D texture, where there is one
    already. `others`: media beside it; see `together`.
    """

    Settings = PopSettings

    def __init__(
        self,
        gpu: Gpu,
        volume: Volume,
        settings: PopSettings,
        *,
        lights: int = 0,
        voxels: Texture | None = None,
        others: int = 0,
    ) -> None:
        self.settings = settings
        is_beam = settings.scheme == "delta-beam"
        self.medium = GridMedium(
            gpu, volume, settings.grid, voxels=voxels, others=others if is_beam else 0
        )
        medium, kind = self.medium, Beams if is_beam else HoppingBeams
        self.emission = Emission(gpu, medium.placement, medium.mix)
        self.beams = kind(
            medium,
            settings,
            settings.ordinates + lights,
            medium.mix,
            bounced=self.emission.bounced,
            takes_others=True,
        )
        self.white = Mix(gpu, medium.placement.cells, medium.mix.media - 1, has_blocks=False)
        has_furnace = is_beam and settings.furnace_correction > 0.0
        self.furnace = (
            Beams(medium, settings, settings.ordinates, self.white) if has_furnace else None
        )
        self._scene_ordinates = SceneOrdinates(settings.ordinates, settings.ordinates_from)
        self._importance = ViewImportance() if settings.importance == "view" else None
        self._even = even_sky(settings.ordinates) if self.furnace else None
        self._bounce: Bounce | None = None
        self._light_key: tuple[Any, ...] = ()
        self._view_key = b""

    def encode(
        self,
        commands: Commands,
        lights: tuple[Light, ...],
        environment: Environment | None,
        eye: F64,
        volume: Volume | None = None,
        surfaces: Surfaces | None = None,
        bounced: ReflectedLight | None = None,
        look: Look | None = None,
    ) -> Texture:
        """The texture of in-scattered radiance towards `eye` (world, m); see `source`.

        `volume`: the medium as it is now; of the same box and grid size as at the start.
        `surfaces`: what shades it; `bounced`: what light they reflect into it. `look`: the view,
        where importance asks for it. Of one medium alone; see `together.encode`.
        """
        lit = Illumination(
            lights, environment, np.asarray(eye, np.float64), surfaces, bounced, look
        )
        new_medium = self.begin(commands, lit, volume)
        if new_medium:
            self.encode_medium(commands, lit)
        new_light = self.is_new_light(lit) or new_medium
        if new_light:
            self.encode_light(commands, lit)
        self.encode_view(commands, lit, new_medium=new_medium, new_light=new_light)
        return self.emission.texture

    def begin(self, commands: Commands, lit: Illumination, volume: Volume | None) -> bool:
        """Take the light and medium; whether the medium changed."""
        if volume is not None and volume is not self.medium.volume:
            self.medium.take(volume)
        with commands.stage("pop ordinates"):
            seen = self._seen(lit.environment, lit.look)
            self._ordinates = self._scene_ordinates.of(lit.lights, lit.environment, seen)
        self._lamps = lamps_of(lit.lights)
        # Virtual lights' rows are written on the device.
        self._virtual = lit.surfaces.virtual_lights if lit.surfaces else 0
        self._lamps += [_DARK] * self._virtual
        count = self._ordinates.count + len(self._lamps) + self.beams.blocks
        self.medium.params = self.medium.params_of(count)
        return self.medium.encode(commands)

    def is_new_light(self, lit: Illumination) -> bool:
        """Whether the light is not the last lit's."""
        versions = () if lit.surfaces is None else lit.surfaces.version
        versions += () if lit.bounced is None else lit.bounced.version
        directions, power = self._ordinates.direction, self._ordinates.irradiance
        key = (directions.tobytes(), power.tobytes(), *self._lamps, *versions)
        is_new, self._light_key = key != self._light_key, key
        return is_new

    def encode_light(self, commands: Commands, lit: Illumination) -> None:
        """Beams and what leaves them; other media dark."""
        # Where surfaces are all the light there is, the lattice's unit is the scale.
        is_dark = lit.bounced is not None and not self._ordinates.count and not self._lamps
        scale = lit.bounced.source.scale if lit.bounced and is_dark else 0.0
        self.beams.write(self._ordinates, self._lamps, scale, virtual=self._virtual)
        self._write_gain(self.beams, self._scene_ordinates.sky)
        if lit.surfaces is not None:
            self.beams.write_surfaces(self._ordinates, lit.lights, lit.surfaces)
        medium = self.medium
        self.beams.encode(commands, medium.params, medium.placement.point(lit.eye))

    def source(self, medium: int) -> Source:
        """The last emission for `march`; `medium` is the volume's row in `media.gpu_media`."""
        return Source(
            self.emission.texture,
            self.medium.placement.uvw_from_world,
            scale=self.beams.table.scale,
            medium=medium,
        )

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return {
            "ordinates": self.beams.table.count,
            "grid": list(self.medium.placement.count),
            "scheme": self.settings.scheme,
            "hops": getattr(self.beams, "iterations", 0),
            "iterations": self.settings.solver_steps,
        }

    def _seen(self, environment: Environment | None, look: Look | None) -> F64 | None:
        """What the camera sees of the map, where that is asked for."""
        if self._importance is None or look is None or environment is None:
            return None
        medium = self.medium
        return self._importance.of(medium.volume, medium.placement, look, environment.rotation_deg)

    def encode_medium(self, commands: Commands, lit: Illumination) -> None:
        """What a changed medium needs, or a change of one that it is mixed with."""
        medium = self.medium
        medium.encode_mix(commands)
        medium.write_mix(self.white, is_white=True)
        with commands.stage("pop density"):
            self.beams.encode_medium(commands, medium.params)
        if self.furnace is not None and self._even is not None:
            white = medium.params_of(self._even.count, _WHITE)
            self.furnace.write(self._even, (), 1.0)
            self._write_gain(self.furnace, even_light(self._even))
            self.furnace.encode_medium(commands, white)
            self.furnace.encode(commands, white)
        if lit.bounced is not None:
            self._bounce = self._bounce or Bounce(medium, self.settings)
            even = medium.params_of(self._bounce.count)
            self._bounce.encode_medium(commands, even, lit.bounced)

    def encode_view(
        self, commands: Commands, lit: Illumination, *, new_medium: bool, new_light: bool
    ) -> None:
        """What the eye sees of it, where that changed."""
        new_view = new_medium or lit.eye.tobytes() != self._view_key
        if not (new_view or new_light):
            return
        self._view_key = lit.eye.tobytes()
        medium, bounced = self.medium, lit.bounced
        local = medium.placement.point(lit.eye)
        if new_view and self.furnace is not None:
            with commands.stage("pop emission"):
                white = medium.params_of(self.furnace.table.count, _WHITE)
                self.emission.encode_furnace(
                    commands,
                    white,
                    local,
                    self.furnace.table,
                    self.furnace.paths.passed,
                    self.furnace.diffuse.diffuse,
                    medium.density.reach,
                    self.white,
                )
        if bounced is not None and self._bounce is not None:
            with commands.stage("pop bounce"):
                even = medium.params_of(self._bounce.count)
                self._bounce.encode(
                    commands, even, local, bounced, self.beams.table.scale, self.emission.bounced
                )
        self.beams.encode_view(commands, medium.params, local, self.emission)

    def _write_gain(self, beams: Beams, sky: SkyLight | None) -> None:
        if self.settings.exact_sky:
            medium, prefilter = self.medium, self.settings.prefilter
            beams.table.gain.write(sky, medium.placement, medium.volume.g, prefilter=prefilter)
