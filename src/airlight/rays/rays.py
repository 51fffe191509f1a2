"""A scene's triangles as rays meet them: hierarchies of meshes, and one of the instances over them.

meshes      a hierarchy each, built once; fitted again when vertices move, rebuilt when that
            has made it too costly
instances   a hierarchy over their boxes, rebuilt whenever one of them moves
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.commands import Commands
from ..gpu.device import Gpu
from ..gpu.memory import Buffer, buffer_of
from ..gpu.slots import Slot, storage
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from .hierarchy import INDEX_MASK, LEAF, build, child_boxes
from .mesh_tree import MeshTree
from .words import NODE_WORDS, moved_children, node_words

INSTANCE_ROWS = 8
"""Of four words, of an instance: object from world, world from object, and what it shows."""
INSTANCE_LEVELS = 10
_LOOSE = 2e-6  # of its farthest coordinate, by which an instance's box is wider than it

RAY_SLOTS: tuple[Slot, ...] = (
    storage("ray_nodes", "vec4u"),
    storage("ray_triangles", "vec4u"),
    storage("ray_instances", "vec4u"),
)
"""What a pass with `//! use rays` binds beside its own; `RayScene.bound` are the values."""


class RayScene:
    """The buffers of RAY_SLOTS for the meshes of a `GpuScene`.

    `update` before rays are sent; instances and materials are numbered as in the GpuScene.
    """

    def __init__(self, gpu: Gpu, scene: GpuScene) -> None:
        self.gpu, self._scene = gpu, scene
        self._keys = [scene.first_vertices[index] for index in scene.order]
        self.trees: dict[int, MeshTree] = {}
        self._moved: set[int] = set()
        self._packed = b""
        self._take(scene.current)
        self._lay()
        self._place(scene.current)

    @property
    def bound(self) -> dict[str, Any]:
        """The values of RAY_SLOTS."""
        return {
            "ray_nodes": self.nodes,
            "ray_triangles": self.triangles,
            "ray_instances": self.instances,
        }

    @property
    def constants(self) -> dict[str, float]:
        """Constants of the pipelines that use `wgsl/rays.wgsl`: what this scene needs of it."""
        return {"RAYS_MEET_MASKS": 0.0}

    @property
    def stats(self) -> dict[str, Any]:
        """Triangles (of each geometry once), instances, bytes on the device."""
        return {
            "triangles": sum(len(tree.tree.order) for tree in self.trees.values()),
            "instances": len(self._keys),
            "bytes": self.nodes.nbytes + self.triangles.nbytes + self.instances.nbytes,
        }

    def update(self, commands: Commands, scene: Scene) -> None:
        """Follow the meshes of `scene`: those of creation, as they are in this frame.

        What moved is uploaded before all that `commands` submits from here on.
        """
        if scene.meshes is self._meshes:
            return
        self._take(scene.meshes)
        if any(tree.nodes_needed > self._rooms[key] for key, tree in self.trees.items()):
            self._lay()
        for key in self._moved:
            self._write(key)
        self._moved.clear()
        self._place(scene.meshes)

    def _take(self, meshes: Sequence[Mesh]) -> None:
        """Build the hierarchies of new geometries, and fit those of the ones that moved."""
        self._meshes = meshes
        for key, index in zip(self._keys, self._scene.order, strict=True):
            geometry = meshes[index].geometry
            tree = self.trees.get(key)
            if tree is None:
                self.trees[key] = MeshTree(geometry)
            elif tree.geometry is not geometry:
                tree.move(geometry)
                self._moved.add(key)

    def _lay(self) -> None:
        """Make the buffers: nodes of the instances, then those of each mesh; its triangles."""
        node, triangle = max(1, len(self._keys)), 0
        self._firsts: dict[int, tuple[int, int]] = {}
        self._rooms: dict[int, int] = {}
        for key, tree in self.trees.items():
            self._firsts[key], self._rooms[key] = (node, triangle), tree.nodes_needed
            node, triangle = node + tree.nodes_needed, triangle + len(tree.tree.order)
        for name in ("nodes", "triangles", "instances"):
            if hasattr(self, name):
                getattr(self, name).release()
        row = 4 * NODE_WORDS
        self.nodes = Buffer(self.gpu, "ray nodes", row * node)
        self.triangles = Buffer(self.gpu, "ray triangles", row * max(1, triangle))
        rows = np.zeros((max(1, len(self._keys)), 4 * INSTANCE_ROWS), np.uint32)
        self.instances = buffer_of(self.gpu, "ray instances", rows)
        self._packed = b""
        for key in self.trees:
            self._write(key)

    def _write(self, key: int) -> None:
        tree, (node, triangle) = self.trees[key], self._firsts[key]
        words = tree.nodes.copy()
        words[:, 12:16] = moved_children(words[:, 12:16], node, triangle)
        self.nodes.write(words, 4 * NODE_WORDS * node)
        self.triangles.write(tree.triangles, 4 * NODE_WORDS * triangle)

    def _place(self, meshes: Sequence[Mesh]) -> None:
        """Build the hierarchy over the instances where they stand."""
        rows = self._instance_rows(meshes)
        low, high = self._boxes(meshes)
        packed = rows.tobytes() + low.tobytes() + high.tobytes()
        if packed == self._packed:
            return
        self._packed = packed
        self.instances.write(rows)
        there = np.flatnonzero(np.isfinite(low).all(axis=1))
        tree = build(low[there], high[there], most=1, levels=INSTANCE_LEVELS)
        lows, highs = child_boxes(tree, low[there][tree.order], high[there][tree.order])
        words = node_words(tree, lows, highs)
        # Leaves lead to instances themselves, not to a place in an order.
        children = tree.children.ravel()
        is_leaf = children >= LEAF
        items = there[tree.order][children[is_leaf] & INDEX_MASK]
        flat = words[:, 12:16].reshape(-1).copy()
        flat[is_leaf] = LEAF | items.astype(np.uint32)
        words[:, 12:16] = flat.reshape(-1, 4)
        self.nodes.write(words)

    def _instance_rows(self, meshes: Sequence[Mesh]) -> NDArray[np.uint32]:
        rows = np.zeros((max(1, len(self._keys)), 4 * INSTANCE_ROWS), np.uint32)
        floats = rows.view(np.float32)
        if not self._keys:
            return rows
        matrices = np.stack([meshes[index].world_from_object for index in self._scene.order])
        floats[:, :12] = _inverses(matrices)[:, :3].reshape(-1, 12)
        floats[:, 12:24] = matrices[:, :3].reshape(-1, 12)
        rows[:, 24] = [self._firsts[key][0] for key in self._keys]
        rows[:, 25] = self._scene.material_rows
        return rows

    def _boxes(self, meshes: Sequence[Mesh]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Around the instances, a little wider; not finite where an instance is flattened."""
        ordered = [meshes[index] for index in self._scene.order]
        boxes = np.array([mesh.world_bounds for mesh in ordered]).reshape(-1, 2, 3)
        wider = _LOOSE * np.abs(boxes).max(axis=(1, 2), initial=0.0)[:, None]
        is_flat = [not _is_invertible(mesh.world_from_object) for mesh in ordered]
        boxes[is_flat] = np.nan
        low, high = boxes[:, 0] - wider, boxes[:, 1] + wider
        return low.astype(np.float32), high.astype(np.float32)


def _is_invertible(matrix: NDArray[np.float64]) -> bool:
    """Whether a transform leaves a volume, as single precision can tell."""
    sides = np.linalg.norm(matrix[:3, :3], axis=0).prod()
    return bool(abs(np.linalg.det(matrix[:3, :3])) > 1e-6 * sides)


def _inverses(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those of transforms (N, 4, 4); zero where there is none."""
    found = np.zeros_like(matrices)
    for index, matrix in enumerate(matrices):
        if _is_invertible(matrix):
            found[index] = np.linalg.inv(matrix)
    return found
