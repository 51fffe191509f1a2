"""The emission grids of all volumes on the device: boxes of one texture (`atlas`)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..errors import SceneError
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..maths.half import half_floats
from ..scene.checks import Rgb
from ..scene.medium import Medium
from ..scene.scene import Scene
from ..scene.volume import Volume
from .atlas import LIMIT, Region, packed

NO_GRID = Region((0, 0, 0), (0, 0, 0))
"""Of a volume without an emission grid."""


class EmissionGrids:
    """rgb in 0..1: the share of the brightest voxel's emission. Sizes are fixed.

    `places`: the texels of each volume's grid.
    """

    def __init__(self, gpu: Gpu, volumes: Sequence[Volume]) -> None:
        """For the `volumes` of a scene, of which one at least has an emission grid.

        Raises SceneError where the grids do not fit into one texture.
        """
        self._seen: list[Volume] = list(volumes)
        # Grids lie side by side in one texture; a volume without one has no place in it.
        sizes = [v.emission.size if v.emission else None for v in volumes]
        boxes, size = packed([(s[2], s[1], s[0]) for s in sizes if s], gpu.limits[LIMIT])
        self.texture = Texture(gpu, "emission grids", size, "rgba16float", dimension="3d")
        # Boxes come in the order of the volumes that have a grid.
        found = iter(boxes)
        self.places = [NO_GRID if s is None else next(found) for s in sizes]
        for volume, place in zip(volumes, self.places, strict=True):
            self._write(volume, place)

    def update(self, volumes: Sequence[Volume]) -> bool:
        """Upload the grids that are not the last frame's; returns whether there were any.

        Raises SceneError where a grid comes, goes or changes in size.
        """
        changed = False
        # Volumes are frozen: the same emission holds the same grid.
        for i, (volume, old) in enumerate(zip(volumes, self._seen, strict=True)):
            self._seen[i] = volume
            if volume.emission is old.emission:
                continue
            have, had = (v.emission.size if v.emission else None for v in (volume, old))
            # A grid keeps its place in the texture, which was as large as the grid.
            if have != had:
                raise SceneError(
                    "a volume's emission got a grid, lost it, or its grid changed in size",
                    remedy="Make a new Renderer",
                )
            if have:
                self._write(volume, self.places[i])
                changed = True
        return changed

    def _write(self, volume: Volume, place: Region) -> None:
        if place is NO_GRID:
            return
        emission = volume.emission
        assert emission and emission.values is not None
        # Half floats end at 65504, so texels hold shares of the peak, which the medium's row
        # multiplies.
        texels = np.zeros((*emission.values.shape[:3], 4), np.float16)
        scale = 1.0 / max(emission.peak, 1e-30)
        half_floats(emission.values, scale, out=texels[..., :3])
        x, y, z = place.first
        self.texture.write(texels, layer=z, row=y, column=x)


def has_emission(scene: Scene) -> bool:
    """Whether any medium gives off light itself."""
    own = scene.medium is not None and max(scene.medium.emission) > 0.0
    return own or any(v.is_emissive for v in scene.volumes)


def glows(volume: Volume) -> bool:
    """Whether a volume's voxels say by themselves how much they emit."""
    return volume.emission is not None and volume.emission.size is not None


def brightest_emission(of: Medium | Volume) -> Rgb:
    """W m^-3 sr^-1 of the brightest voxel, or at density 1."""
    if isinstance(of, Medium):
        return of.emission
    if of.emission is None:
        return (0.0, 0.0, 0.0)
    # Glow is proportional to the grid's values, of which the peak is the largest.
    r, g, b = (c * of.emission.peak for c in of.emission.radiance)
    return (r, g, b)
