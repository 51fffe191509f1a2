"""The node tree of a file in motion: what hangs on its nodes, and what they deform."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from ...maths.transforms import trs_matrix
from ..camera import Camera
from ..checks import F64
from ..lights import Light
from ..placing import moved_camera
from .curve import Curve
from .skin import Shape
from .tracks import Placing

if TYPE_CHECKING:
    from ..mesh import Mesh
    from ..scene import Scene


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Nodes at rest. `order` names those of the scene, (node, parent or -1), parents first.

    `translation` (N, 3), `rotation` (N, 4) quaternions xyzw, `scale` (N, 3); `matrix` by node
    replaces the three.
    """

    order: tuple[tuple[int, int], ...]
    translation: F64
    rotation: F64
    scale: F64
    matrix: Mapping[int, F64]

    def world(self, clip: Clip | None, time_s: float) -> F64:
        """world_from_node (N, 4, 4) in the file's world; of nodes outside the scene the identity.

        Node by node down the tree: there are few, and each needs its parent's.
        """
        moved = {} if clip is None else {k: c.at(time_s) for k, c in clip.channels.items()}
        world = np.tile(np.eye(4), (len(self.translation), 1, 1))
        for node, parent in self.order:
            local = self._local(node, moved)
            world[node] = local if parent < 0 else world[parent] @ local
        return world

    def _local(self, node: int, moved: Mapping[tuple[int, str], F64]) -> F64:
        # A node of a matrix is not animated, as glTF has it.
        if node in self.matrix:
            return self.matrix[node]
        t, r, s = (
            moved.get((node, path), getattr(self, path)[node])
            for path in ("translation", "rotation", "scale")
        )
        return trs_matrix(t, r, s)


@dataclass(frozen=True, eq=False)
class Clip:
    """One animation of a file: curves by (node, path), and morph weights by node."""

    name: str
    channels: Mapping[tuple[int, str], Curve]
    weights: Mapping[int, Curve]

    @property
    def end_s(self) -> float:
        """Its last keyframe."""
        curves = [*self.channels.values(), *self.weights.values()]
        return max((curve.end_s for curve in curves), default=0.0)


@dataclass(frozen=True, eq=False)
class Part:
    """A mesh of the scene: the node it hangs on, and, where it is deformed, its shape.

    `weights` (M,) are the morph targets' at rest. `local` (4, 4): where an instance stands on
    its node.
    """

    node: int
    shape: Shape | None = None
    weights: F64 | None = None
    local: F64 | None = None


@dataclass(frozen=True, eq=False)
class Rig:
    """`parts` are the scene's meshes from `first_mesh` on, `lights` its lights from `first_light`.

    `lights` hold a node and the light in its space; `camera` likewise, where the scene looks
    through the file's. `world_from_file` (4, 4) or a Placing stands over all. The clip starts at
    `start_s` and runs `speed` times as fast as the file says, over and over with `is_loop`.
    """

    skeleton: Skeleton
    parts: tuple[Part, ...]
    lights: tuple[tuple[int, Light], ...] = ()
    camera: tuple[int, Camera] | None = None
    clips: tuple[Clip, ...] = ()
    clip: int = 0
    first_mesh: int = 0
    first_light: int = 0
    world_from_file: F64 | Placing = field(default_factory=lambda: np.eye(4))
    start_s: float = 0.0
    speed: float = 1.0
    is_loop: bool = False

    moves_meshes = True

    @property
    def is_moving(self) -> bool:
        """Whether the file has an animation."""
        return bool(self.clips)

    @property
    def end_s(self) -> float:
        """When it comes to rest, seconds; infinite in a loop."""
        # The placement may move on when the clip has ended.
        placed = self.world_from_file.end_s if isinstance(self.world_from_file, Placing) else 0.0
        if not self.clips:
            return placed
        if self.is_loop:
            return float("inf")
        return max(placed, self.start_s + self.clips[self.clip].end_s / self.speed)

    @property
    def camera_alone(self) -> Rig | None:
        """What it does to the camera; None where it leaves that alone."""
        return replace(self, parts=(), lights=()) if self.camera is not None else None

    def apply(self, scene: Scene, time_s: float) -> Scene:
        """The scene with the file's meshes, lights and camera as they are."""
        return self._posed(scene, self.clips[self.clip] if self.clips else None, time_s)

    def at_rest(self, scene: Scene) -> Scene:
        """The same without any animation: skins and morph targets as the file's nodes stand."""
        return self._posed(scene, None, 0.0)

    def _posed(self, scene: Scene, clip: Clip | None, time_s: float) -> Scene:
        # Every node of the file at this time, in the file's space and in the world.
        at = self._clip_time(clip, time_s)
        place = self.world_from_file
        placed = place.at(time_s) if isinstance(place, Placing) else place
        in_file = self.skeleton.world(clip, at)
        world = placed @ in_file
        # What hangs on a node goes with it: meshes, lights, and the camera if the file has one.
        meshes, lights = list(scene.meshes), list(scene.lights)
        for k, part in enumerate(self.parts, start=self.first_mesh):
            meshes[k] = self._mesh(meshes[k], part, clip, at, in_file, placed)
        for k, (node, light) in enumerate(self.lights, start=self.first_light):
            lights[k] = light.moved(world[node])
        scene = replace(scene, meshes=tuple(meshes), lights=tuple(lights))
        if self.camera is None:
            return scene
        # Exposure stays the scene's.
        node, camera = self.camera
        seen = moved_camera(camera, world[node])
        return replace(scene, camera=replace(seen, exposure_stops=scene.camera.exposure_stops))

    def _clip_time(self, clip: Clip | None, time_s: float) -> float:
        # Clip time begins at `start_s` and runs `speed` times as fast.
        time = (time_s - self.start_s) * self.speed
        if clip is None or not self.is_loop or clip.end_s <= 0.0:
            return time
        return time % clip.end_s

    def _mesh(
        self, mesh: Mesh, part: Part, clip: Clip | None, at: float, in_file: F64, placed: F64
    ) -> Mesh:
        world = cast(F64, placed @ in_file[part.node])
        if part.local is not None:
            world = world @ part.local
        # A rigid mesh moves as a whole.
        if part.shape is None:
            return replace(mesh, world_from_object=world)
        # One with a skin or morph targets gets new vertices.
        if part.shape.skin is not None:
            world = placed  # a skinned mesh does not hang on its node (section 3.7.3.2)
        # Weights at rest, unless the clip animates them.
        weights = np.zeros(0) if part.weights is None else part.weights
        if clip is not None and part.node in clip.weights:
            weights = clip.weights[part.node].at(at)
        now = part.shape.deformed(weights, in_file)
        geometry = replace(
            mesh.geometry, positions=now.positions, normals=now.normals, tangents=now.tangents
        )
        return replace(mesh, geometry=geometry, world_from_object=world)
