"""Scenes as techniques take them: lights with surfaces, volumes of one colour each."""

from __future__ import annotations

from .coefficients import in_parts
from .light_shapes import LightMeshes
from .scene import Scene


class ShownScenes:
    """Puts the meshes of lights among the others, and cuts volumes of many colours into parts."""

    def __init__(self) -> None:
        self._light_meshes = LightMeshes()

    def of(self, scene: Scene) -> Scene:
        """The scene as it is drawn; the very same where nothing of it is replaced."""
        return in_parts(self._light_meshes.of(scene))


def drawn_alike(one: Scene, other: Scene) -> bool:
    """Whether the volumes of two scenes have as many parts: what is made for one fits the other."""
    counts = [tuple(len(volume.parts) for volume in scene.volumes) for scene in (one, other)]
    return counts[0] == counts[1] or len(counts[0]) != len(counts[1])
