"""The white furnace: what multiple scattering has to be multiplied by to conserve power.

Under a uniform sky of radiance 1 a medium without absorption scatters exactly 1 everywhere. Solved
with as many ordinates and cells as the frame, it does so with an error, which is about that of the
frame.
"""

from __future__ import annotations

from ..gpu.commands import Commands
from ..maths.ordinates import uniform_sky
from ..maths.transforms import F64
from .delta.beams import DeltaBeams
from .delta.emission import Emission
from .light.ordinates import uniform_light
from .medium.grid_medium import GridMedium
from .medium.mixture import Mixture
from .medium.placement import MediumParams
from .settings import PopSettings

_WHITE = (1.0, 1.0, 1.0)


class Furnace:
    """One medium without absorption under a uniform sky of radiance 1."""

    def __init__(
        self, medium: GridMedium, settings: PopSettings, outer: Furnace | None = None
    ) -> None:
        """`outer`: of a finer grid, that of the next larger one."""
        self._medium, self._is_exact = medium, settings.exact_sky
        # The table of media is a copy in which nothing absorbs; no light of other media enters.
        self._mixture = Mixture(medium.gpu, medium.cells, medium.mixture.count, has_blocks=False)
        around: DeltaBeams | None = outer._beams if outer else None
        self._beams: DeltaBeams = DeltaBeams(
            medium, settings, settings.ordinates, self._mixture, outer=around
        )
        self._sky = uniform_sky(settings.ordinates)

    def encode_medium(self, commands: Commands) -> None:
        """Take a changed medium: solve it."""
        self._medium.write_mixture(self._mixture, is_white=True)
        params, beams = self._params, self._beams
        # The uniform sky, with the correction of single scattering that the frame's sky has.
        beams.write(self._sky, (), 1.0)
        if self._is_exact:
            beams.light.write_correction(uniform_light(self._sky))
        beams.encode_medium(commands, params)
        beams.encode(commands, params)

    def encode_view(self, commands: Commands, eye: F64, emission: Emission) -> None:
        """Fill the corrections of `emission` for an eye (3,), m in the frame of the medium."""
        beams = self._beams
        emission.encode_furnace(commands, self._params, eye, beams.light, beams.diffuse)

    @property
    def _params(self) -> MediumParams:
        return self._medium.params_of(self._sky.count, _WHITE)
