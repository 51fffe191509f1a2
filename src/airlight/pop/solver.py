"""One medium under lights, environment and surfaces, top to bottom (Elek2014).

    begin          the light as a few principal ordinates (5.1); the medium on a grid of its own
    encode_medium  its density in cells, and the operators that depend on nothing else
    encode_light   attenuation between every cell and every ordinate (4.1), then multiple
                   scattering: by diffusion, or from cell to cell in a grid per ordinate (4.2, 4.3)
    encode_view    the radiance that each cell scatters towards the eye (4.4), which is then marched

Nothing is precomputed, and what did not change since the last frame is not computed again. Several
media of a scene have a solver each, and light one another; see `several_media`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import SceneError
from ..fields import Source
from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..maths.ordinates import Ordinates
from ..maths.transforms import F64
from ..scene.lights import PointLight
from ..scene.volume import Volume
from .delta.emission import Emission
from .furnace import Furnace
from .indirect import IndirectLight
from .light.illumination import Illumination
from .light.importance import ViewImportance
from .light.ordinates import SceneOrdinates, local_lights
from .medium.finer_medium import FinerMedium
from .medium.grid_medium import NO_OTHERS, GridMedium
from .medium.mixture import MediaCount
from .schemes import scheme_of
from .settings import PopSettings
from .transport import Transport

# A row for each virtual light, which the device fills in.
_VIRTUAL = PointLight((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class PopSolver:
    """The light that one volume scatters.

    `medium`: the volume on its grid. `transport`: the light in it. `emission`: towards the eye.
    The size of the grid and the most lights are fixed. `finer`: the solver of the next finer grid
    inside this one, which takes the same ordinates, and whose light enters from this one.
    """

    Settings = PopSettings
    medium: GridMedium
    transport: Transport

    def __init__(
        self,
        gpu: Gpu,
        volume: Volume | Sequence[Volume] | GridMedium | PopSolver,
        settings: PopSettings,
        *,
        lights: int = 0,
        voxels: Texture | None = None,
        others: MediaCount = NO_OTHERS,
        has_local_shafts: bool = False,
    ) -> None:
        """For at most so many `lights` beside the environment, and a number of `others`.

        `volume`: one, its parts of the same phase function, a medium that has its grid, or the
        solver of the next larger grid. `voxels`: the density as a filterable 3D texture, if any.
        `has_local_shafts`: as of `Emission`. Raises SceneError for parts in schemes of hops.
        """
        # A solver given as the volume has the next larger grid; this one solves a finer grid in it.
        outer = volume if isinstance(volume, PopSolver) else None
        given = volume.medium if isinstance(volume, PopSolver) else volume
        self.settings, self._outer = settings, outer
        is_beam = settings.scheme == "delta-beam"
        # Grids of ordinates know one medium only.
        others = others if is_beam else NO_OTHERS
        if isinstance(given, Sequence) and len(given) > 1 and not is_beam:
            raise SceneError(
                f"scheme = '{settings.scheme}' knows no volume whose colour varies",
                remedy="Use scheme = 'delta-beam', or another technique",
            )
        # The medium on its grid, and its ordinates; nested grids share those.
        if outer is None:
            self.medium = GridMedium.made_of(
                gpu, given, settings.grid, voxels=voxels, others=others
            )
            self._scene_ordinates = SceneOrdinates(settings.ordinates, settings.ordinates_from)
        else:
            self.medium = FinerMedium(outer.medium, settings.grid_ratio)
            self._scene_ordinates = outer._scene_ordinates
        # The light in the cells, and what of it goes towards the eye.
        self.emission = Emission(self.medium, settings, has_local_shafts=has_local_shafts)
        around, capacity = outer.transport if outer else None, settings.ordinates + lights
        self.transport = scheme_of(self.emission, settings, capacity, around)
        # The furnace measures what the scheme gets wrong under a uniform sky.
        self._furnace: Furnace | None = None
        if is_beam and settings.furnace_correction > 0.0:
            self._furnace = Furnace(self.medium, settings, outer._furnace if outer else None)
        self._importance = ViewImportance() if settings.importance == "view" else None
        self._indirect: IndirectLight | None = None
        self._light_key: tuple[Any, ...] = ()
        self._view_key = b""
        self.finer: PopSolver | None = None
        if is_beam and self.medium.level + 1 < settings.grid_levels:
            self.finer = PopSolver(
                gpu, self, settings, lights=lights, has_local_shafts=has_local_shafts
            )

    def encode(
        self, commands: Commands, lit: Illumination, volume: Sequence[Volume] | Volume | None = None
    ) -> Texture:
        """Solve one medium alone; returns the texture of in-scattered radiance towards the eye.

        `volume`: the medium as it is in this frame; of the same box and grid size as at the start.
        """
        # The ordinates, and the medium.
        is_new_medium = self.begin(commands, lit, volume)
        if is_new_medium:
            self.encode_medium(commands, lit)
        # Light in the cells.
        is_new_light = self.is_new_light(lit) or is_new_medium
        if is_new_light:
            self.encode_light(commands, lit)
        # Radiance towards the eye.
        self.encode_view(commands, lit, is_new_medium=is_new_medium, is_new_light=is_new_light)
        self.encode_finer(commands, lit, is_new_light=is_new_light)
        return self.emission.texture

    def encode_finer(self, commands: Commands, lit: Illumination, *, is_new_light: bool) -> None:
        """Solve the finer grids inside this one, if any, ahead of the eye.

        `is_new_light`: whether this one was solved again.
        """
        finer = self.finer
        if finer is None:
            return
        assert isinstance(finer.medium, FinerMedium)
        # The finer grid stays ahead of the camera.
        camera = lit.look.camera if lit.look else None
        look = np.subtract(camera.target, camera.position) if camera else np.zeros(3)
        finer.medium.follow(lit.eye, look)
        # A moved medium is lit again, and new light is seen again.
        is_moved = finer.begin(commands, lit, self.medium.volumes)
        if is_moved:
            finer.encode_medium(commands, lit)
        is_new = is_new_light or is_moved
        if is_new:
            finer.encode_light(commands, lit)
        finer.encode_view(commands, lit, is_new_medium=is_moved, is_new_light=is_new)
        finer.encode_finer(commands, lit, is_new_light=is_new)

    def begin(
        self, commands: Commands, lit: Illumination, volume: Sequence[Volume] | Volume | None
    ) -> bool:
        """Take the light and the medium of a frame; returns whether the medium changed."""
        # Another volume is placed again, and so is a grid that follows the camera.
        parts = (volume,) if isinstance(volume, Volume) else volume or self.medium.volumes
        is_same = [*map(id, parts)] == [*map(id, self.medium.volumes)]
        if not is_same or self._outer is not None:
            self.medium.take(parts)
        # Directional lights and environment as ordinates, directed to what the camera sees. Local
        # lights follow, then virtual point lights, whose rows the device fills.
        with commands.stage("pop ordinates"):
            self._ordinates = self._ordinates_of(lit)
        self._virtual = lit.surfaces.virtual_lights if lit.surfaces else 0
        self._local = local_lights(lit.lights) + [_VIRTUAL] * self._virtual
        # Blocks of other media have the last rows of the ordinates.
        count = self._ordinates.count + len(self._local) + self.transport.light.blocks
        self.medium.params = self.medium.params_of(count, around=lit.around)
        return self.medium.encode(commands)

    def _ordinates_of(self, lit: Illumination) -> Ordinates:
        """Those of the frame; nested grids share them."""
        # Nested grids of one medium share its ordinates.
        if self._outer is not None:
            return self._outer._ordinates
        importance = self._importance_of(lit)
        return self._scene_ordinates.of(lit.lights, lit.environment, importance)

    def _importance_of(self, lit: Illumination) -> F64 | None:
        """The importance of the environment for the camera, where the settings ask for it."""
        environment, look = lit.environment, lit.look
        if self._importance is None or look is None or environment is None:
            return None
        medium = self.medium
        return self._importance.of(medium.volume, medium.placement, look, environment.rotation_deg)

    def encode_medium(self, commands: Commands, lit: Illumination) -> None:
        """Take a changed medium, or a change of one of the others."""
        medium = self.medium
        medium.encode_mixture(commands)
        # The operator of the diffusion solve.
        with commands.stage("pop density"):
            self.transport.encode_medium(commands, medium.params)
        # The medium without absorption under a uniform sky: the furnace.
        if self._furnace is not None:
            self._furnace.encode_medium(commands)
        # The medium under a uniform sky: the share of indirect light that reaches each cell.
        if lit.reflected is not None:
            outer = self._outer._indirect if self._outer else None
            self._indirect = self._indirect or IndirectLight(medium, self.settings, outer)
            uniform = medium.params_of(self._indirect.count)
            self._indirect.encode_medium(commands, uniform, lit.reflected)

    def is_new_light(self, lit: Illumination) -> bool:
        """Whether the light is not that of the last frame."""
        # Equal bytes are the same light; virtual point lights count by the versions of their maps.
        directions, power = self._ordinates.direction, self._ordinates.irradiance
        key = (directions.tobytes(), power.tobytes(), *self._local, *lit.versions)
        is_new, self._light_key = key != self._light_key, key
        return is_new

    def encode_light(self, commands: Commands, lit: Illumination) -> None:
        """Solve the light in the cells, while other media are dark."""
        medium, transport = self.medium, self.transport
        # Where indirect light is all there is, its unit is the scale.
        is_dark = not self._ordinates.count and not self._local
        scale = lit.reflected.source.scale if lit.reflected and is_dark else 0.0
        scale = self._outer.scale if self._outer else scale
        # The ordinates, corrected so that single scattering of the sky is exact.
        transport.write(self._ordinates, self._local, scale, virtual=self._virtual)
        if self.settings.exact_sky:
            transport.light.write_correction(self._scene_ordinates.sky)
        if lit.surfaces is not None:
            transport.write_surfaces(self._ordinates, lit.lights, lit.surfaces)
        transport.encode(commands, medium.params, medium.placement.point(lit.eye))

    def encode_view(
        self, commands: Commands, lit: Illumination, *, is_new_medium: bool, is_new_light: bool
    ) -> None:
        """Fill `emission` for the eye, where anything changed."""
        # What is scattered towards the eye changes with it, even where all light stays.
        is_new_view = is_new_medium or lit.eye.tobytes() != self._view_key
        if not (is_new_view or is_new_light):
            return
        medium, self._view_key = self.medium, lit.eye.tobytes()
        eye = medium.placement.point(lit.eye)
        # Corrections for which a white medium under a uniform sky scatters exactly its radiance.
        if is_new_view and self._furnace is not None:
            with commands.stage("pop emission"):
                self._furnace.encode_view(commands, eye, self.emission)
        # Indirect light of surfaces.
        if lit.reflected is not None and self._indirect is not None:
            with commands.stage("pop bounce"):
                uniform = medium.params_of(self._indirect.count)
                target = self.emission.indirect
                self._indirect.encode(commands, uniform, eye, lit.reflected, self.scale, target)
        # Light of the ordinates, scattered once and more often, and all of it together.
        self.transport.encode_view(commands, medium.params, eye, self.emission)
        walls = self.transport.diffuse.walls
        self.emission.smooth.encode(commands, medium.params, self.emission.texture, walls)

    @property
    def scale(self) -> float:
        """The unit of `emission`, W m^-2 sr^-1 per unit scattering coefficient."""
        return self.transport.light.table.scale

    def sources(self, medium: int) -> list[Source]:
        """The last emission for marching, the finest grid first.

        `medium`: the row of the volume in `media.gpu_media`.
        """
        own = self.medium
        source = Source(
            self.emission.smooth.texture,
            own.placement.uvw_from_world,
            scale=self.scale,
            medium=medium,
            parts=len(own.parts),
            whole=self.emission.whole,
            mean=self.emission.mean if self.transport.has_mean else None,
            texels=self.emission.smooth.TEXELS,
            fade=own.grid.shares if isinstance(own, FinerMedium) else None,
        )
        return [*(self.finer.sources(medium) if self.finer else ()), source]

    @property
    def stats(self) -> dict[str, Any]:
        """What was solved, for --stats."""
        return {
            "ordinates": self.transport.light.table.count,
            "grid": list(self.medium.placement.count),
            "grid_levels": 1 + (self.finer.stats["grid_levels"] if self.finer else 0),
            "scheme": self.settings.scheme,
            "hops": self.transport.iterations,
            "iterations": self.settings.solver_steps,
        }
