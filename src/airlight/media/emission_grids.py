"""The emission grids of all volumes on the device: one texture, stacked along z."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..maths.half import half_floats
from ..scene.checks import Rgb, Vec3
from ..scene.medium import Medium
from ..scene.scene import Scene
from ..scene.volume import Volume


@dataclass(frozen=True)
class GridPlace:
    """Texels of one grid in the texture, x y z; none where `count` is 0."""

    first: Vec3 = (0.0, 0.0, 0.0)
    count: Vec3 = (0.0, 0.0, 0.0)


NO_GRID = GridPlace()


class EmissionGrids:
    """rgb in 0..1: the share of the brightest voxel's emission. Sizes are fixed."""

    def __init__(self, gpu: Gpu, volumes: Sequence[Volume]) -> None:
        """For the `volumes` of a scene, of which one at least has an emission grid."""
        self._seen: list[Volume] = list(volumes)
        self.places: list[GridPlace] = []
        sizes = [v.emission.size for v in volumes if v.emission and glows(v)]
        height, width = (max(s[axis] for s in sizes if s) for axis in (1, 2))
        depth = 0
        for volume in volumes:
            place = NO_GRID
            if glows(volume) and volume.emission and volume.emission.size:
                z, y, x = volume.emission.size
                place = GridPlace((0.0, 0.0, float(depth)), (float(x), float(y), float(z)))
                depth += z
            self.places.append(place)
        self.texture = Texture(
            gpu, "emission grids", (width, height, depth), "rgba16float", dimension="3d"
        )
        for volume, place in zip(volumes, self.places, strict=True):
            self._write(volume, place)

    def update(self, volumes: Sequence[Volume]) -> bool:
        """Upload the grids that are not the last frame's; returns whether there were any."""
        changed = False
        for i, (volume, old) in enumerate(zip(volumes, self._seen, strict=True)):
            self._seen[i] = volume
            if volume.emission is old.emission:
                continue
            have, had = (v.emission.size if v.emission else None for v in (volume, old))
            if have != had:
                raise SceneError(
                    "a volume's emission got a grid, lost it, or its grid changed in size",
                    remedy="Make a new Renderer",
                )
            if have:
                self._write(volume, self.places[i])
                changed = True
        return changed

    def _write(self, volume: Volume, place: GridPlace) -> None:
        if place is NO_GRID:
            return
        emission, (width, height, _) = volume.emission, self.texture.size
        assert emission and emission.values is not None
        z, y, x = emission.values.shape[:3]
        rows: NDArray[np.float16] = np.zeros((z, height, width, 4), np.float16)
        scale = 1.0 / max(emission.peak, 1e-30)
        half_floats(emission.values, scale, out=rows[:, :y, :x, :3])
        self.texture.write(rows, layer=int(place.first[2]))


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
    r, g, b = (c * of.emission.peak for c in of.emission.radiance)
    return (r, g, b)
