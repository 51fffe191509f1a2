"""What mirrored rays ask of materials that they meet: do they mirror again, do they glow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..gpu.device import Gpu
from ..gpu.layout import Struct, f32, pack_array, u32, vec3f
from ..gpu.memory import buffer_of
from ..maths.reflection import bihemispherical_albedo
from ..scene.material import Material
from ..scene.mesh import Mesh
from .albedo import reduced


class GlossData(Struct):
    """A material, as the end of a mirrored ray."""

    glow = vec3f("W m^-2 sr^-1, the mean of its map")
    metallic = f32("0 to 1, the mean of its map")
    alpha = f32("roughness squared")
    two_sided = u32("whether it glows on both sides")
    f0 = f32("of its coat, what it mirrors of light straight on")
    coat = f32("of light from all around, what its coat mirrors")


class Glosses:
    """The rows of materials in the order of a scene's `original` meshes; their glow may change."""

    def __init__(self, gpu: Gpu, original: Sequence[Mesh]) -> None:
        # Meshes of one material share its row, by the first of them.
        first: dict[int, int] = {}
        for index, mesh in enumerate(original):
            first.setdefault(id(mesh.material), index)
        self._meshes = list(first.values())
        self._scope = gpu.scope()
        self._shown: list[tuple[float, float, float]] | None = None
        # Paths go on from mirror to mirror where there is metal.
        self.mirrors = any(original[k].material.metallic > 0.0 for k in self._meshes)
        """Whether any of them mirrors what mirrored rays bring."""

    def follow(self, current: Sequence[Mesh]) -> None:
        """Upload what glows as `current` meshes do, where that has changed."""
        # What glows may flicker, the rest of a material stays.
        materials = [current[k].material for k in self._meshes]
        glow = [material.emission for material in materials]
        if glow == self._shown:
            return
        self._scope.release()
        rows = pack_array(GlossData, [gloss_row(material) for material in materials])
        self.rows, self._shown = buffer_of(self._scope, "glosses", rows), glow


def gloss_row(material: Material) -> dict[str, object]:
    """The values of a material's GlossData: maps by their means."""
    glow, gloss = np.asarray(material.emission, np.float64), np.ones(3)
    # A row has no texels: of textures it takes the mean.
    if material.emission_texture is not None:
        glow = glow * reduced(material.emission_texture, (1, 1))[0, 0]
    if material.metallic_roughness_texture is not None:
        gloss = reduced(material.metallic_roughness_texture, (1, 1))[0, 0]
    roughness = material.roughness * float(gloss[1])
    # What the coat alone mirrors of light from all around.
    coat = bihemispherical_albedo(np.zeros((1, 3)), [0.0], [roughness], [material.specular])
    return {
        "glow": tuple(glow),
        "metallic": material.metallic * float(gloss[2]),
        "alpha": max(roughness**2, 0.002),
        "two_sided": int(material.two_sided),
        "f0": 0.04 * material.specular,
        "coat": float(coat[0, 0]),
    }
