"""Alpha of materials with holes as rays read it: coverage in bytes, beside the instances' rows.

A ray meets a translucent surface by the chance that light does not pass it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..maths.arrays import U32
from ..scene.material import Material, Texture
from ..scene.mesh import Mesh
from ..surface.materials import chance_to_meet, uv_transform
from ..surface.packed_maps import WRAP_BITS

INSTANCE_WORDS = 40
"""Of an instance: object from world and world from object (12 each), the first node of its mesh,
its material, the first word of its mask (0: none), the mask's width and height (16 bits each); the
scale and offset of its coordinates; the least alpha that is there, how it wraps, the first node of
all that are static, the chance to be met (of translucent ones, else 0), 1 where alpha is coverage;
3 unused."""
MOST_SIDE = 1024
"""Texels of a mask's longer side; of larger textures each texel is the mean of several."""


class Masks:
    """`rows` (I + 1, INSTANCE_WORDS): what instances show, the last all that are static.

    `texels` lie behind the rows: four to a word, each mask from a word of its own.
    """

    def __init__(self, meshes: Sequence[Mesh], materials: Sequence[int]) -> None:
        """`meshes` and the rows of their `materials`, in the scene's order."""
        self.rows: U32 = np.zeros((len(meshes) + 1, INSTANCE_WORDS), np.uint32)
        floats = self.rows.view(np.float32)
        self._first = self.rows.size
        self._parts: list[U32] = []
        self._known: dict[int, tuple[int, int]] = {}
        # By instance: its material, and how likely a ray meets what is blended.
        for index, (mesh, row) in enumerate(zip(meshes, materials, strict=True)):
            self.rows[index, 25] = row
            material = mesh.material
            texture = material.base_color_texture
            floats[index, 35] = chance_to_meet(material) if material.is_translucent else 0.0
            is_cut = material.alpha_cutoff > 0.0 or material.is_blended
            # A texture without alpha has no holes.
            if texture is None or not is_cut or bool((texture.pixels[..., 3] == 255).all()):
                continue
            # Of holes the map of alpha, and where it lies on the mesh.
            self.rows[index, 26:28] = self._place(texture)
            floats[index, 28:32] = uv_transform(texture)
            floats[index, 32] = material.alpha_cutoff / max(material.alpha, 1e-6)
            self.rows[index, 36] = int(material.is_blended)
            self.rows[index, 33] = WRAP_BITS[texture.wrap[0]] | WRAP_BITS[texture.wrap[1]] << 2
        self._parts.append(np.zeros(-self._first % 4, np.uint32))  # to whole rows
        self.texels: U32 = np.concatenate(self._parts)

    @cached_property
    def has_holes(self) -> list[bool]:
        """Of each instance, whether rays may pass it."""
        return [bool(first or met) for first, met in self.rows[:-1, [26, 35]]]

    @cached_property
    def are_there(self) -> bool:
        """Whether any instance has holes."""
        return any(self.has_holes)

    def _place(self, texture: Texture) -> tuple[int, int]:
        """Where a texture's mask begins, in words, and its width | height << 16."""
        # Each image once; four bytes to a word.
        key = id(texture.pixels)
        if key not in self._known:
            alpha = _coverage(texture)
            height, width = alpha.shape
            words = np.zeros(-(-alpha.size // 4), np.uint32)
            words.view(np.uint8)[: alpha.size] = alpha.ravel()
            self._known[key] = (self._first, width | height << 16)
            self._parts.append(words)
            self._first += len(words)
        return self._known[key]


def is_gone(material: Material) -> bool:
    """Whether no part of a material is there: its alpha is below its cutoff everywhere."""
    return material.alpha < material.alpha_cutoff


def _coverage(texture: Texture) -> NDArray[np.uint8]:
    """Its alpha (H, W), no side longer than MOST_SIDE."""
    # Means over whole blocks; the remainder at the right and the bottom is less than one.
    alpha = texture.pixels[..., 3]
    steps = [-(-side // MOST_SIDE) for side in alpha.shape]
    if steps == [1, 1]:
        return alpha
    rows, columns = (side // step for side, step in zip(alpha.shape, steps, strict=True))
    cut = alpha[: rows * steps[0], : columns * steps[1]]
    blocks = cut.reshape(rows, steps[0], columns, steps[1])
    means = blocks.mean(axis=(1, 3), dtype=np.float32)
    return np.asarray(np.round(means), np.uint8)
