"""Boxes of texels in one 3D texture: WebGPU binds few textures, and a shader cannot index them.

Density grids lie in one atlas, and so do their columns towards the lights. A box is filtered within
itself: coordinates are clamped to the centres of its outer texels, so that boxes may touch. Beside
the density a texel holds how far it is to the next that is not empty, which marching steps over.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..gpu.device import Gpu
from ..gpu.memory import Texture
from ..maths.empty_voxels import empty_distances
from ..maths.half import half_floats
from ..scene.checks import F32

Size = tuple[int, int, int]
LIMIT = "max-texture-dimension-3d"
MOST_WITH_DISTANCES = 1 << 24
"""Texels of an atlas; larger ones hold densities alone, half the bytes: nothing is stepped over."""


@dataclass(frozen=True)
class Region:
    """A box of texels: where it begins and how many there are along x, y, z."""

    first: Size
    count: Size


def packed(counts: Sequence[Size], most: int) -> tuple[list[Region], Size]:
    """Where boxes of these counts lie, and the size of their texture, at most `most` on an axis.

    Boxes are laid in rows along x, rows in layers along y, layers on one another, the largest
    first. A single box is the whole texture. Raises SceneError where they do not fit.
    """
    # Rows and layers about as long as the whole is high: a cube has the least waste.
    texels = sum(x * y * z for x, y, z in counts)
    side = min(most, int(np.ceil(1.25 * np.cbrt(texels))))
    width = max(side, max(c[0] for c in counts))
    height = max(side, max(c[1] for c in counts))
    regions: dict[int, Region] = {}
    # What the row, the layer and the whole have taken, and how thick row and layer are.
    x = y = z = row = layer = 0
    order = sorted(range(len(counts)), key=lambda i: (counts[i][2], counts[i][1]), reverse=True)
    for i in order:
        nx, ny, nz = counts[i]
        # A full row opens the next one, a full layer the next layer.
        if x + nx > width:
            x, y, row = 0, y + row, 0
        if y + ny > height:
            x, y, row, z, layer = 0, 0, 0, z + layer, 0
        regions[i] = Region((x, y, z), counts[i])
        x, row, layer = x + nx, max(row, ny), max(layer, nz)
    # The texture ends where the farthest grid does.
    ends = [np.add(r.first, r.count) for r in regions.values()]
    size = tuple(int(n) for n in np.max(ends, axis=0))
    if max(size) > most:
        raise SceneError(
            f"density grids of {texels:,} texels in all do not fit into one texture of {most} on a "
            "side",
            remedy="Use fewer or coarser grids",
        )
    return [regions[i] for i in range(len(counts))], (size[0], size[1], size[2])


class DensityAtlas:
    """The density grids of a scene's volumes; those of one and the same array share its texels."""

    def __init__(self, gpu: Gpu, densities: Sequence[F32]) -> None:
        self._gpu = gpu
        self.version = 0
        """Raised whenever a grid was uploaded."""
        self._make(densities)

    def _make(self, densities: Sequence[F32]) -> None:
        # One box for each array that there is, filled at once.
        own: dict[int, int] = {}
        self._box_of = [own.setdefault(id(density), len(own)) for density in densities]
        arrays = [densities[self._box_of.index(box)] for box in range(len(own))]
        # Beside the density lies the distance to the next voxel that is not empty, by which rays
        # skip; large atlases go without, for memory.
        counts = [(a.shape[2], a.shape[1], a.shape[0]) for a in arrays]
        boxes, size = packed(counts, self._gpu.limits[LIMIT])
        has_distances = size[0] * size[1] * size[2] <= MOST_WITH_DISTANCES
        texels = "rg16float" if has_distances else "r16float"
        self.texture = Texture(self._gpu, "density", size, texels, dimension="3d")
        self._boxes, self._arrays = boxes, list(arrays)
        # What was made of a grid is made again once its version is another.
        self.version += 1
        self._filled = [self.version] * len(boxes)
        for box, array in zip(boxes, arrays, strict=True):
            _fill(self.texture, box, array)

    @property
    def regions(self) -> list[Region]:
        """By grid."""
        return [self._boxes[box] for box in self._box_of]

    @property
    def versions(self) -> list[int]:
        """By grid: the version in which its densities became what they are."""
        return [self._filled[box] for box in self._box_of]

    @property
    def is_alone(self) -> bool:
        """Whether the texture holds one volume's grid and nothing else."""
        return len(self._box_of) == 1

    def update(self, densities: Sequence[F32]) -> None:
        """Upload the grids that are not the last ones.

        Raises SceneError where a grid has another number of cells.
        """
        # Arrays are compared by identity: another array is uploaded.
        wanted: dict[int, F32] = {}
        for box, density in zip(self._box_of, densities, strict=True):
            old = self._arrays[box].shape
            if density.shape != old:
                raise SceneError(
                    f"a volume's grid changed from {old} to {density.shape} cells",
                    remedy="Make a new Renderer",
                )
            if wanted.setdefault(box, density) is not density:
                # Grids that were one and are no longer: each gets a box of its own.
                self.texture.release()
                self._make(densities)
                return
        changed = [box for box, density in wanted.items() if density is not self._arrays[box]]
        for box in changed:
            _fill(self.texture, self._boxes[box], wanted[box])
            self._arrays[box] = wanted[box]
            self._filled[box] = self.version + 1
        self.version += bool(changed)


def _fill(texture: Texture, box: Region, density: NDArray[Any]) -> None:
    x, y, z = box.first
    texels = half_floats(density)
    # Rays step over empty voxels where the texture holds how far those reach.
    if texture.format == "rg16float":
        texels = np.stack([texels, empty_distances(texels)], axis=-1)
    texture.write(texels, layer=z, row=y, column=x)
