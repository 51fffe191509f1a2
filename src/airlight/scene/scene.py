"""Everything that is to be rendered, in one immutable value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import one_line
from .camera import Camera
from .checks import F64
from .environment import Environment
from .lights import Light
from .medium import Medium
from .mesh import Mesh, world_boxes
from .point_lights import PointLights
from .volume import Volume

if TYPE_CHECKING:
    from .animation import Animation


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
        # They quote names from files, which may hold anything.
        object.__setattr__(self, "warnings", tuple(one_line(text) for text in self.warnings))

    def at(self, time_s: float) -> Scene:
        """The scene at `time_s`, seconds; the very same where nothing moves.

        It depends on the time alone, not on what was asked before. Raises SceneError.
        """
        return self if self.animation is None else self.animation.at(self, time_s)

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
        return (
            np.min([low for low, _ in boxes], axis=0),
            np.max([high for _, high in boxes], axis=0),
        )

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
