"""A volume on a grid of its own, and the media beside it: what every pass over its cells binds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...errors import SceneError
from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.memory import Buffer, Texture
from ...maths.half import half_floats
from ...scene.checks import Rgb
from ...scene.volume import Volume
from .density import Density, density_texture, voxel_count
from .mixture import MediaCount, Mixture
from .placement import (
    SPHERE_SIDE,
    MediumParams,
    MediumPlacement,
    PlacedVolume,
    placed_parts,
    shape_density,
)
from .surrounding import SurroundingMedium

NO_OTHERS = MediaCount()


@dataclass
class ScatteredLight:
    """Light that a medium scatters, for the others: power that left beams, and diffuse light.

    `deposits` and `diffuse` as `delta.diffuse` has them; `scale`: radiance per stored unit.
    """

    deposits: Buffer
    diffuse: Buffer
    scale: float = 0.0


class GridMedium:
    """A volume, its `density` in cells, and the `others`, whose number is fixed.

    A volume of varying colour is several `parts` with one phase function, on one grid.

    `mixture`: the coefficients of all of them in its cells. `params`: for passes over the ordinates
    of the frame. `scattered`: set by the scheme that solves it. `voxels`: textures of the parts.
    """

    params: MediumParams
    scattered: ScatteredLight
    level = 0
    """How many larger grids lie around this one."""

    def __init__(
        self,
        gpu: Gpu,
        parts: Sequence[Volume],
        resolution: int,
        *,
        voxels: Texture | None = None,
        others: MediaCount = NO_OTHERS,
    ) -> None:
        """`voxels`: the density of the only part as a filterable 3D texture, if there is one."""
        self.gpu, self._resolution = gpu, resolution
        self.parts = self._placed(parts)
        self.others: tuple[GridMedium, ...] = ()
        # Its own parts come first in the table of media, those of the others follow.
        count = others._replace(own=len(parts))
        self.mixture = Mixture(gpu, self.placement.cells, count)
        self.density = Density(gpu, self.placement, self.mixture)
        # A density that is on the device already is neither uploaded nor written here.
        self._own_voxels = voxels is None
        self.voxels = [density_texture(gpu, v) for v in parts] if voxels is None else [voxels]
        self._key: tuple[Any, ...] = ()

    @classmethod
    def made_of(
        cls,
        gpu: Gpu,
        given: GridMedium | Volume | Sequence[Volume],
        resolution: int,
        *,
        voxels: Texture | None = None,
        others: MediaCount = NO_OTHERS,
    ) -> GridMedium:
        """That of a volume or its parts; one that is there already stays."""
        if isinstance(given, GridMedium):
            return given
        parts = [given] if isinstance(given, Volume) else given
        return cls(gpu, parts, resolution, voxels=voxels, others=others)

    def _placed(self, parts: Sequence[Volume]) -> list[PlacedVolume]:
        """The parts on this grid."""
        return placed_parts(parts, self._resolution)

    @property
    def whole(self) -> GridMedium:
        """The largest grid of the same volume."""
        return self

    def moved_to(self, placement: MediumPlacement) -> list[PlacedVolume]:
        """The parts on another grid."""
        return [replace(part, placement=placement) for part in self.parts]

    def meet(self, others: Sequence[GridMedium]) -> None:
        """Set the other media; none of them if this one was made for none.

        (The schemes that propagate in grids know one medium only.)
        """
        self.others = tuple(others) if self.mixture.count.others else ()

    @property
    def volumes(self) -> list[Volume]:
        """The parts of this frame."""
        return [part.volume for part in self.parts]

    @property
    def placed(self) -> PlacedVolume:
        """The first of them, which says where all are and what their phase function is."""
        return self.parts[0]

    @property
    def volume(self) -> Volume:
        """The volume of this frame, or its first part."""
        return self.parts[0].volume

    @property
    def albedo(self) -> tuple[float, float, float]:
        """Of all parts together."""
        # Scattering over extinction, both weighted by mass.
        mass = [np.multiply(p.volume.sigma_t, p.width.mass) for p in self.parts]
        scattered = [m * p.volume.albedo for m, p in zip(mass, self.parts, strict=True)]
        r, g, b = np.sum(scattered, axis=0) / np.maximum(np.sum(mass, axis=0), 1e-30)
        return (float(r), float(g), float(b))

    @property
    def placement(self) -> MediumPlacement:
        """Where the grid is."""
        return self.parts[0].placement

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return self.placement.cells

    @property
    def fine_others(self) -> list[Texture]:
        """The fine densities of its further parts, then of the others."""
        of_others = [(other.density.fine, *other.density.fine_parts) for other in self.others]
        return [*self.density.fine_parts, *(fine for fines in of_others for fine in fines)]

    def write_mixture(self, mixture: Mixture, *, is_white: bool = False) -> None:
        """Upload this medium and the others to `mixture`; without absorption if `is_white`."""
        every = [*self.parts, *(part for other in self.others for part in other.parts)]
        mixture.write(every, is_white=is_white)

    def params_of(
        self,
        ordinates: int,
        albedo: Rgb | None = None,
        around: SurroundingMedium | None = None,
    ) -> MediumParams:
        """The parameters of passes over so many `ordinates`; with another `albedo`, if any, and
        the transmittance of a medium `around` this one."""
        fields = self.parts[0].fields(ordinates)
        fields |= {} if albedo is None else {"albedo": albedo}
        fields |= {} if around is None else around.fields(self.placement)
        return MediumParams(**fields)

    def take(self, volumes: Sequence[Volume]) -> None:
        """Go on with changed parts. Raises SceneError where their grids' size changed."""
        # Textures were sized at creation, so only what fits into them is taken.
        made = self._placed(volumes)
        if len(made) != len(self.parts):
            raise SceneError("the volume's colours changed in number", remedy="Make a new Renderer")
        for new, old in zip(made, self.parts, strict=True):
            same_voxels = voxel_count(new.volume) == voxel_count(old.volume)
            same_grid = new.placement.count == old.placement.count
            if not (same_voxels and same_grid and new.volume.shape == old.volume.shape):
                raise SceneError("the volume changed in size", remedy="Make a new Renderer")
        # Nothing changes where any part is refused.
        for new, old, voxels in zip(made, self.parts, self.voxels, strict=True):
            if self._own_voxels and new.volume.density is not old.volume.density:
                voxels.write(half_floats(shape_density(new.volume, SPHERE_SIDE)))
        self.parts = made

    def encode(self, commands: Commands) -> bool:
        """Fill the medium's own density where the volume changed; returns whether it did."""
        # All that the density in cells and their coefficients depend on.
        v = self.volume
        key: tuple[Any, ...] = (v.g, v.world_from_volume.tobytes(), v.bounds)
        key += (self.placement.world_from_medium.tobytes(),)
        key += tuple((id(p.density), p.sigma_t, p.albedo) for p in self.volumes)
        if key == self._key:
            return False
        self._key = key
        with commands.stage("pop density"):
            self.density.encode(commands, self.params, self.voxels)
        return True

    def encode_mixture(self, commands: Commands) -> None:
        """Fill `mixture` and the densities of the others, after all have theirs."""
        self.write_mixture(self.mixture)
        with commands.stage("pop density"):
            self.density.encode_others(commands, self.params, self.fine_others)
