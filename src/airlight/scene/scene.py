"""Everything that is to be rendered, in one immutable value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import one_line
from ..maths.transforms import box_around
from . import checks
from .camera import Camera
from .checks import F64
from .environment import Environment
from .lights import Light
from .lights.light_type import LightType
from .medium import Medium
from .mesh import Mesh, world_boxes
from .point_lights import PointLights
from .volume import Volume

if TYPE_CHECKING:
    from .animation import Animation


_SEVERAL: dict[str, type] = {
    "meshes": Mesh,
    "lights": LightType,
    "volumes": Volume,
    "light_groups": PointLights,
}
_ONE: dict[str, type] = {"camera": Camera, "environment": Environment, "medium": Medium}
"""What fields of a scene hold: many of a type, or one, which may be missing but for a camera."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Meshes, lights, media and a camera. Change one with `dataclasses.replace`.

    `environment` is what surrounds the scene, `medium` what fills it, `volumes` are media within
    bounds; `meshes` are its surfaces. `name` is for files and messages. `settings` holds what a
    scene file says under [technique.NAME], unchecked until used. `warnings` are what a loader
    dropped, replaced or approximated, for the user to read. `animation` says what moves.
    `light_groups` are lights by the thousand, for lattices.
    """

    meshes: tuple[Mesh, ...] = ()
    lights: tuple[Light, ...] = ()
    environment: Environment | None = None
    camera: Camera = field(default_factory=Camera)
    medium: Medium | None = None
    volumes: tuple[Volume, ...] = ()
    settings: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    name: str = "scene"
    warnings: tuple[str, ...] = ()
    animation: Animation | None = None
    light_groups: tuple[PointLights, ...] = ()

    def __post_init__(self) -> None:
        self._check_types()
        # They quote names from files, which may hold anything.
        object.__setattr__(self, "warnings", tuple(one_line(text) for text in self.warnings))

    def _check_types(self) -> None:
        # Of each type what is in it is known to be right; here, that it is of that type.
        put = object.__setattr__
        for name, kind in _SEVERAL.items():
            given = getattr(self, name)
            held = checks.instances(given, f"the scene's {name}", kind)
            if held is not given:
                put(self, name, held)
        for name, kind in _ONE.items():
            value = getattr(self, name)
            if value is not None or name == "camera":
                checks.instance(value, f"the scene's {name}", kind)

    def at(self, time_s: float) -> Scene:
        """The scene at `time_s`, seconds; the very same where nothing moves.

        It depends on the time alone, not on what was asked before. Raises SceneError.
        """
        time = checks.number(time_s, "time_s")
        return self if self.animation is None else self.animation.at(self, time)

    @property
    def bounds(self) -> tuple[F64, F64]:
        """Lower and upper corner, metres, of all surfaces and volumes.

        Else of the medium, where it has bounds; else around the camera.
        """
        # The boxes of all that has one.
        boxes: list[Any] = [*world_boxes(self.meshes)]
        boxes += [volume_world_bounds(volume) for volume in self.volumes]
        # With nothing else, what there is to see is the medium, or the camera's surroundings.
        if not boxes and self.medium is not None and self.medium.bounds is not None:
            low, high = self.medium.bounds
            return np.array(low), np.array(high)
        if not boxes:
            eye = np.array(self.camera.position)
            return eye - 1.0, eye + 1.0
        return box_around(boxes)

    @property
    def whole_bounds(self) -> tuple[F64, F64]:
        """The same over all of the animation's time: what a lattice must hold."""
        return self.bounds if self.animation is None else self.animation.bounds(self)

    @property
    def triangle_count(self) -> int:
        """Triangles in all meshes, instances counted each."""
        return sum(len(mesh.geometry.indices) for mesh in self.meshes)


def volume_world_bounds(volume: Volume) -> tuple[F64, F64]:
    """The axis-aligned world box, metres, around a placed volume."""
    low, high = volume.bounds
    corners = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, 8).T
    placed = corners @ volume.world_from_volume[:3, :3].T + volume.world_from_volume[:3, 3]
    return placed.min(axis=0), placed.max(axis=0)
