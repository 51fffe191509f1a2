"""A volume on a grid of its own, and the media beside it: what every pass over its cells binds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...errors import SceneError
from ...gpu.commands import Commands
from ...gpu.device import Gpu
from ...gpu.memory import Buffer, Texture
from ...maths.half import half_floats
from ...scene.volume import Volume
from .density import Density, density_texture, voxel_count
from .mixture import Mixture
from .placement import SPHERE_SIDE, MediumParams, MediumPlacement, PlacedVolume, shape_density


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

    `mixture`: the coefficients of all of them in its cells. `params`: for passes over the ordinates
    of the frame. `scattered`: set by the scheme that solves it.
    """

    params: MediumParams
    scattered: ScatteredLight

    def __init__(
        self, gpu: Gpu, volume: Volume, resolution: int, *, voxels: Texture | None, others: int
    ) -> None:
        """`voxels`: the density as a filterable 3D texture, where there is one already."""
        self.gpu, self._resolution = gpu, resolution
        self.placed = PlacedVolume.of(volume, resolution)
        self.others: tuple[GridMedium, ...] = ()
        self.mixture = Mixture(gpu, self.placement.cells, others)
        self.density = Density(gpu, self.placement, self.mixture)
        self._own_voxels = voxels is None
        self._voxels = density_texture(gpu, volume) if voxels is None else voxels
        self._key: tuple[Any, ...] = ()

    def meet(self, others: Sequence[GridMedium]) -> None:
        """Set the other media; none of them if this one was made for none.

        (The schemes that propagate in grids know one medium only.)
        """
        self.others = () if self.mixture.is_alone else tuple(others)

    @property
    def volume(self) -> Volume:
        """The volume of this frame."""
        return self.placed.volume

    @property
    def placement(self) -> MediumPlacement:
        """Where the grid is."""
        return self.placed.placement

    @property
    def cells(self) -> int:
        """How many cells there are."""
        return self.placed.placement.cells

    @property
    def fine_others(self) -> list[Texture]:
        """The fine densities of the others."""
        return [other.density.fine for other in self.others]

    def write_mixture(self, mixture: Mixture, *, is_white: bool = False) -> None:
        """Upload this medium and the others to `mixture`; without absorption if `is_white`."""
        mixture.write(self.placed, [other.placed for other in self.others], is_white=is_white)

    def params_of(
        self, ordinates: int, albedo: tuple[float, float, float] | None = None
    ) -> MediumParams:
        """The parameters of passes over so many `ordinates`; with another `albedo`, if any."""
        fields = self.placed.fields(ordinates)
        return MediumParams(**(fields if albedo is None else fields | {"albedo": albedo}))

    def take(self, volume: Volume) -> None:
        """Go on with a changed volume. Raises SceneError where its grid's size changed."""
        old, new = self.placed, PlacedVolume.of(volume, self._resolution)
        same_voxels = voxel_count(volume) == voxel_count(old.volume)
        same_grid = new.placement.count == old.placement.count
        if not (same_voxels and same_grid and volume.shape == old.volume.shape):
            raise SceneError("the volume changed in size", remedy="Make a new Renderer")
        if self._own_voxels and volume.density is not old.volume.density:
            self._voxels.write(half_floats(shape_density(volume, SPHERE_SIDE)))
        self.placed = new

    def encode(self, commands: Commands) -> bool:
        """Fill the medium's own density where the volume changed; returns whether it did."""
        v = self.volume
        key = (id(v.density), v.sigma_t, v.albedo, v.g, v.world_from_volume.tobytes(), v.bounds)
        if key == self._key:
            return False
        self._key = key
        with commands.stage("pop density"):
            self.density.encode(commands, self.params, self._voxels)
        return True

    def encode_mixture(self, commands: Commands) -> None:
        """Fill `mixture` and the densities of the others, after all have theirs."""
        self.write_mixture(self.mixture)
        with commands.stage("pop density"):
            self.density.encode_others(commands, self.params, self.fine_others)
