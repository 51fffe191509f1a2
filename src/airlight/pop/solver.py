"""One scattering medium under sun, sky and lamps: the technique, top to bottom (Elek2014).

Light is cut into ordinates, a beam each; every cell marches towards all of them, what leaves the
beams spreads by diffusion, and for every eye each cell is told what it scatters towards it. Nothing
is precomputed; what did not change since the last frame is not done again.

Several media of a scene have a solver each, which shade and light one another; see `together`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import SceneError
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..march.march import Source
from ..maths.ordinates import even_sky
from ..maths.transforms import F64
from ..scene.environment import Environment
from ..scene.lights import Light, PointLight
from ..scene.settings import setting
from ..scene.volume import Volume
from .bounce import Bounce, Bounced
from .density import Density, density_texture, half_floats, voxel_count
from .diffuse import GROUP
from .emission import Emission
from .importance import WAYS, Look, ViewImportance
from .mixture import Mix
from .ordinates import MAKERS, SceneOrdinates, even_light, lamps_of
from .placement import (
    SPHERE_SIDE,
    MediumParams,
    medium_fields,
    medium_width,
    placed,
    shape_density,
)
from .schemes import SCHEMES, Beams, HoppingBeams
from .sky_gain import SkyLight
from .visibility import Surfaces

_DARK = PointLight((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


@dataclass(frozen=True)
class PopSettings:
    """What principal-ordinates propagation can be told."""

    scheme: str = setting(
        "delta-beam",
        "how light spreads: beams and diffusion; hops, corrected; hops as printed, "
        "3 to 17 times too bright",
        choices=SCHEMES,
    )
    ordinates: int = setting(64, "directions that stand for the environment", low=1, high=512)
    ordinates_from: str = setting(
        "partition", "how a map becomes directions: parts of it, or samples of it as in the paper",
        choices=tuple(MAKERS),
    )  # fmt: skip
    importance: str = setting(
        "none", "where few directions are drawn to: the map's light alone, or what the camera sees "
        "of it, too", choices=WAYS,
    )  # fmt: skip
    grid: int = setting(
        20, "cells along a side of a cube-shaped medium; others get as many", low=4, high=64
    )
    iterations: int = setting(20, "most hops of light (split, paper)", low=1, high=400)
    residuum: bool = setting(True, "hand nearly isotropic light to one shared grid (paper)")
    residuum_iterations: int = setting(20, "hops of the shared grid (paper)", low=0, high=400)
    solver_steps: int = setting(36, "steps of the diffusion solve", low=1, high=512)
    prefilter: bool = setting(True, "spread each ordinate over its part of the sky")
    virtual_lights: int = setting(
        0, "points of lit surfaces whose reflected light media see, once; 0: the light of a "
        "lattice, where there is one", low=0, high=512,
    )  # fmt: skip
    virtual_grids: str = setting(
        "beams", "how the light of virtual lights spreads (delta-beam): as beams, or in hops on "
        "shells around each as in split and paper", choices=("beams", "radial"),
    )  # fmt: skip
    virtual_resolution: int = setting(
        256, "side of the maps that they are taken from", unit="px", low=8, high=4096
    )
    exact_sky: bool = setting(
        True, "whether the sky's light that scatters once is exact in clear air, however few "
        "directions stand for it",
    )  # fmt: skip
    furnace_correction: float = setting(
        1.0, "share of the error under an even sky that is taken off multiple scattering; 0: none",
        low=0.0, high=1.0,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Frame:
    """What media are lit by and seen from; see `PopSolver.encode`."""

    lights: tuple[Light, ...]
    environment: Environment | None
    eye: F64
    surfaces: Surfaces | None = None
    bounced: Bounced | None = None
    look: Look | None = None


class PopSolver:
    """The light that one volume scatters. The grid's size and the most lights are fixed.

    `lights`: how many there can be beside the environment. `voxels`: the volume's density as a
    filterable 3D texture, where there is one already. `others`: media beside it; see `together`.
    """

    Settings = PopSettings

    def __init__(
        self, gpu: Gpu, volume: Volume, settings: PopSettings, *, lights: int = 0,
        voxels: Texture | None = None, others: int = 0,
    ) -> None:  # fmt: skip
        self.gpu, self.settings, self.volume = gpu, settings, volume
        self.placement = placed(volume, settings.grid)
        is_beam = settings.scheme == "delta-beam"
        self.others: tuple[PopSolver, ...] = ()
        self.mix = Mix(gpu, self.placement.cells, others if is_beam else 0)
        self.density = Density(gpu, self.placement, self.mix)
        self.emission = Emission(gpu, self.placement, self.mix)
        kind = Beams if is_beam else HoppingBeams
        self.width = medium_width(volume, self.placement)
        self.beams = kind(gpu, self, settings.ordinates + lights, self.mix, takes_others=True)
        self.white = Mix(gpu, self.placement.cells, self.mix.media - 1, has_blocks=False)
        has_furnace = is_beam and settings.furnace_correction > 0.0
        self.furnace = Beams(gpu, self, settings.ordinates, self.white) if has_furnace else None
        self._scene_ordinates = SceneOrdinates(settings.ordinates, settings.ordinates_from)
        self._importance = ViewImportance() if settings.importance == "view" else None
        self._even = even_sky(settings.ordinates) if self.furnace else None
        self._bounce: Bounce | None = None
        self._own_voxels = voxels is None
        self.voxels = density_texture(gpu, volume) if voxels is None else voxels
        self._medium_key: tuple[Any, ...] = ()
        self._light_key: tuple[Any, ...] = ()
        self._view_key = b""

    def encode(
        self, commands: Commands, lights: tuple[Light, ...], environment: Environment | None,
        eye: F64, volume: Volume | None = None, surfaces: Surfaces | None = None,
        bounced: Bounced | None = None, look: Look | None = None,
    ) -> Texture:  # fmt: skip
        """The texture of in-scattered radiance towards `eye` (world, m); see `source`.

        `volume`: the medium as it is now; of the same box and grid size as at the start.
        `surfaces`: what shades it; `bounced`: what light they reflect into it. `look`: the view,
        where importance asks for it. Of one medium alone; see `together.encode`.
        """
        frame = Frame(lights, environment, np.asarray(eye, np.float64), surfaces, bounced, look)
        new_medium = self.begin(commands, frame, volume)
        if new_medium:
            self.encode_medium(commands, frame)
        new_light = self.is_new_light(frame) or new_medium
        if new_light:
            self.encode_light(commands, frame)
        self.encode_view(commands, frame, new_medium=new_medium, new_light=new_light)
        return self.emission.texture

    def begin(self, commands: Commands, frame: Frame, volume: Volume | None) -> bool:
        """Take the frame's light and medium; whether the medium changed, and `density.fine`."""
        if volume is not None and volume is not self.volume:
            self._take(volume)
        with commands.stage("pop ordinates"):
            seen = self._seen(frame.environment, frame.look)
            self._ordinates = self._scene_ordinates.of(frame.lights, frame.environment, seen)
        self._lamps = lamps_of(frame.lights)
        # Virtual lights' rows are written on the device.
        self._virtual = frame.surfaces.virtual_lights if frame.surfaces else 0
        self._lamps += [_DARK] * self._virtual
        count = self._ordinates.count + len(self._lamps) + self.beams.blocks
        self.params = self._params(count, self.volume.albedo)
        v = self.volume
        key = (id(v.density), v.sigma_t, v.albedo, v.g, v.world_from_volume.tobytes(), v.bounds)
        if key == self._medium_key:
            return False
        self._medium_key = key
        with commands.stage("pop density"):
            self.density.encode(commands, self.params, self.voxels)
        return True

    def is_new_light(self, frame: Frame) -> bool:
        """Whether the light is not the last frame's."""
        versions = () if frame.surfaces is None else frame.surfaces.version
        versions += () if frame.bounced is None else frame.bounced.version
        directions, power = self._ordinates.direction, self._ordinates.irradiance
        key = (directions.tobytes(), power.tobytes(), *self._lamps, *versions)
        is_new, self._light_key = key != self._light_key, key
        return is_new

    def encode_light(self, commands: Commands, frame: Frame) -> None:
        """Beams and what leaves them; other media dark."""
        # Where surfaces are all the light there is, the lattice's unit is the scale.
        is_dark = frame.bounced is not None and not self._ordinates.count and not self._lamps
        scale = frame.bounced.source.scale if frame.bounced and is_dark else 0.0
        self.beams.write(self._ordinates, self._lamps, self.volume, scale, virtual=self._virtual)
        self._write_gain(self.beams, self._scene_ordinates.sky)
        if frame.surfaces is not None:
            self.beams.write_surfaces(self._ordinates, frame.lights, frame.surfaces)
        self.beams.encode(commands, self.params, self.density, self.placement.point(frame.eye))

    def source(self, medium: int) -> Source:
        """The last emission for `march`; `medium` is the volume's row in `march.air`."""
        return Source(self.emission.texture, self.placement.uvw_from_world,
                      scale=self.beams.table.scale, medium=medium)  # fmt: skip

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return {"ordinates": self.beams.table.count, "grid": list(self.placement.count),
                "scheme": self.settings.scheme, "hops": getattr(self.beams, "iterations", 0),
                "iterations": self.settings.solver_steps}  # fmt: skip

    @property
    def mean_density(self) -> float:
        """Of the medium, over its mass."""
        return self.width.density

    def release(self) -> None:
        """Give the memory back."""
        parts = (self.density, self.emission, self.beams, self.furnace, self._bounce)
        for part in (*parts, self.mix, self.white):
            if part is not None:
                part.release()
        if self._own_voxels:
            self.voxels.release()

    def _seen(self, environment: Environment | None, look: Look | None) -> F64 | None:
        """What the camera sees of the map, where that is asked for."""
        if self._importance is None or look is None or environment is None:
            return None
        return self._importance.of(self.volume, self.placement, look, environment.rotation_deg)

    def encode_medium(self, commands: Commands, frame: Frame) -> None:
        """What a changed medium needs, or a change of one that it is mixed with."""
        self.mix.write(self, self.others)
        self.white.write(self, self.others, is_white=True)
        with commands.stage("pop density"):
            self.density.encode_reach(commands, self.params, self.others)
            self.beams.encode_medium(commands, self.params, self.density)
        if self.furnace is not None and self._even is not None:
            white = self._params(self._even.count, (1.0, 1.0, 1.0))
            self.furnace.write(self._even, (), self.volume, 1.0)
            self._write_gain(self.furnace, even_light(self._even))
            self.furnace.encode_medium(commands, white, self.density)
            self.furnace.encode(commands, white, self.density)
        if frame.bounced is not None:
            self._bounce = self._bounce or Bounce(self)
            even = self._params(self._bounce.count, self.volume.albedo)
            self._bounce.encode_medium(commands, even, self.density, frame.bounced)

    def encode_view(
        self, commands: Commands, frame: Frame, *, new_medium: bool, new_light: bool
    ) -> None:
        """What the eye sees of it, where that changed."""
        new_view = new_medium or frame.eye.tobytes() != self._view_key
        if not (new_view or new_light):
            return
        self._view_key = frame.eye.tobytes()
        local, bounced = self.placement.point(frame.eye), frame.bounced
        if new_view and self.furnace is not None:
            with commands.stage("pop emission"):
                white = self._params(self.furnace.table.count, (1.0, 1.0, 1.0))
                self.emission.encode_furnace(
                    commands, white, local, self.furnace.table, self.furnace.paths.passed,
                    self.furnace.diffuse.diffuse, self.density.reach, self.white,
                )  # fmt: skip
        if bounced is not None and self._bounce is not None:
            with commands.stage("pop bounce"):
                even = self._params(self._bounce.count, self.volume.albedo)
                self._bounce.encode(commands, even, local, bounced, self.density)
        self.beams.encode_view(commands, self.params, local, self.emission, self.density)

    def _write_gain(self, beams: Beams, sky: SkyLight | None) -> None:
        if self.settings.exact_sky:
            prefilter = self.settings.prefilter
            beams.table.gain.write(sky, self.placement, self.volume.g, prefilter=prefilter)

    def _params(self, ordinates: int, albedo: tuple[float, float, float]) -> MediumParams:
        fields = medium_fields(self.volume, self.placement, ordinates, self.width, GROUP)
        return MediumParams(**(fields | {"albedo": albedo}))

    def _take(self, volume: Volume) -> None:
        """Go on with a changed volume. Raises SceneError where its grid's size changed."""
        new = placed(volume, self.settings.grid)
        same_voxels = voxel_count(volume) == voxel_count(self.volume)
        same_grid = new.count == self.placement.count and volume.shape == self.volume.shape
        if not (same_voxels and same_grid):
            raise SceneError("the volume changed in size", remedy="Make a new Renderer")
        if self._own_voxels and volume.density is not self.volume.density:
            self.voxels.write(half_floats(shape_density(volume, SPHERE_SIDE)))
        self.placement, self.volume = new, volume
        self.width = medium_width(volume, new)
