"""Scenes as techniques take them: lights with surfaces, suns as lights, volumes of one colour."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from ..errors import SettingsError
from ..maths.sampling import shutter_shares
from .animation.boxes import CommonBoxes
from .coefficients import in_parts, parts_alike
from .light_shapes import LightMeshes
from .map_suns import SunLights
from .scene import Scene
from .volume import Volume


class ShownScenes:
    """Puts the meshes of lights among the others, and the suns of environment maps among lights.

    Volumes of many colours are cut into parts.
    """

    def __init__(self) -> None:
        self._light_meshes, self._suns = LightMeshes(), SunLights()

    def of(self, scene: Scene) -> Scene:
        """The scene as it is drawn; the very same where nothing of it is replaced."""
        return in_parts(self._suns.of(self._light_meshes.of(scene)))


def drawn_alike(one: Scene, other: Scene) -> bool:
    """Whether the volumes of two scenes have parts of the same kinds, and grids of the same size in
    the same boxes: what is made for one fits the other."""
    if len(one.volumes) != len(other.volumes):
        return True  # whoever takes them says what is wrong
    return all(map(_is_drawn_alike, one.volumes, other.volumes))


def _is_drawn_alike(one: Volume, other: Volume) -> bool:
    if one is other:
        return True
    shapes = [None if v.density is None else v.density.shape for v in (one, other)]
    is_same_box = shapes[0] == shapes[1] and (shapes[0] is None or one.bounds == other.bounds)
    return is_same_box and parts_alike(one, other)


def changed(scene: Scene, *, exposure_stops: float | None = None, **changes: Any) -> Scene:
    """`scene` with those of `changes` that are not None, and that exposure of its camera.

    Raises SettingsError for lights of other kinds.
    """
    given = {name: value for name, value in changes.items() if value is not None}
    made = replace(scene, **given) if given else scene
    # A renderer is made for the kinds of its lights, so those have to stay.
    if [type(x) for x in made.lights] != [type(x) for x in scene.lights]:
        raise SettingsError(
            "frame() got lights of other kinds than the scene's", remedy="Make a new Renderer"
        )
    if exposure_stops is None or made.camera.exposure_stops == exposure_stops:
        return made
    return replace(made, camera=replace(made.camera, exposure_stops=exposure_stops))


def shutter_moments(
    before: Scene, scene: Scene, time_s: float, samples: int, changes: Mapping[str, Any]
) -> tuple[Scene, Iterator[Scene]]:
    """`scene`, which is `before` at a time and with `changes`, and what each of its samples sees.

    While the shutter is open each has a moment of its own. Volumes whose boxes differ by then are
    on boxes that hold all of them. Raises SceneError, SettingsError.
    """
    times_s = (time_s + scene.camera.shutter_s * shutter_shares(samples)).tolist()
    is_animated = changes.get("volumes") is None
    boxes = CommonBoxes.at(before, (time_s, *times_s) if is_animated else ())
    return boxes.on(scene), (boxes.on(changed(before.at(t), **changes)) for t in times_s)


def has_unlit(scene: Scene) -> bool:
    """Whether surfaces follow an exposure that comes from the image."""
    is_metered = scene.camera.exposure_stops is None
    return is_metered and any(mesh.material.is_unlit for mesh in scene.meshes)
