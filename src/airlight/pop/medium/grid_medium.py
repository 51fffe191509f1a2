"""A volume on a grid of its own, and the media beside it: what every pass over it takes."""

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
from ..delta.diffuse import GROUP
from .density import Density, density_texture, voxel_count
from .mixture import Mix
from .placement import SPHERE_SIDE, MediumParams, MediumPlacement, PlacedVolume, shape_density


@dataclass
class Sent:
    """Where the light lies that a medium sends to others: out of beams, and diffuse.

    `scale`: radiance per stored unit.
    """

    deposits: Buffer
    diffuse: Buffer
    scale: float = 0.0


class GridMedium:
    """A volume, its `density` in cells, and the `others`, whose number is fixed.

    `mix`: all of them as it meets them. `params`: of the frame's ordinates. `sent`: once it has
    beams.
    """

    params: MediumParams
    sent: Sent

    def __init__(
        self, gpu: Gpu, volume: Volume, resolution: int, *, voxels: Texture | None, others: int
    ) -> None:
        """`voxels`: the density as a filterable 3D texture, where there is one already."""
        self.gpu, self._resolution = gpu, resolution
        self.placed = PlacedVolume.of(volume, resolution)
        self.others: tuple[GridMedium, ...] = ()
        self.mix = Mix(gpu, self.placement.cells, others)
        self.density = Density(gpu, self.placement, self.mix)
        self._own_voxels = voxels is None
        self._voxels = density_texture(gpu, volume) if voxels is None else voxels
        self._key: tuple[Any, ...] = ()

    def meet(self, others: Sequence[GridMedium]) -> None:
        """Know the other media from now on; none of them where it was made without room for any.

        (Light that hops knows of no other medium.)
        """
        self.others = () if self.mix.is_alone else tuple(others)

    @property
    def volume(self) -> Volume:
        """As it is now."""
        return self.placed.volume

    @property
    def placement(self) -> MediumPlacement:
        """Of its grid."""
        return self.placed.placement

    @property
    def fine_others(self) -> list[Texture]:
        """The others' densities."""
        return [other.density.fine for other in self.others]

    def write_mix(self, mix: Mix, *, is_white: bool = False) -> None:
        """Tell `mix` where all are now."""
        mix.write(self.placed, [other.placed for other in self.others], is_white=is_white)

    def params_of(
        self, ordinates: int, albedo: tuple[float, float, float] | None = None
    ) -> MediumParams:
        """With another albedo, where one is given."""
        fields = self.placed.fields(ordinates, GROUP)
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
        """Fill `density.fine` where the volume changed; whether it did."""
        v = self.volume
        key = (id(v.density), v.sigma_t, v.albedo, v.g, v.world_from_volume.tobytes(), v.bounds)
        if key == self._key:
            return False
        self._key = key
        with commands.stage("pop density"):
            self.density.encode(commands, self.params, self._voxels)
        return True

    def encode_mix(self, commands: Commands) -> None:
        """Then what its cells hold of the others."""
        self.write_mix(self.mix)
        with commands.stage("pop density"):
            self.density.encode_reach(commands, self.params, self.fine_others)
