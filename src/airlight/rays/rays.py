"""A scene's triangles as rays meet them.

    still       all instances that stand where they stood at first: one hierarchy in the world
    meshes      a hierarchy each of those that others show, built once; fitted again when vertices
                move, rebuilt when that has made it too costly
    instances   a hierarchy over their boxes and that of the still ones, rebuilt when one moves

What is shown depends on the first frame and on this one, never on those between.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gpu.device import Gpu
from ..gpu.rows import Rows, rows
from ..gpu.slots import Slot
from ..maths.arrays import U32
from ..scene.checks import F32
from ..scene.mesh import Mesh, world_boxes
from ..scene.scene import Scene
from ..surface.geometry import GpuScene
from .hierarchy import INDEX_MASK, LEAF, build, child_boxes
from .masks import INSTANCE_WORDS, Masks, is_gone
from .mesh_tree import MeshTree, StillTree
from .words import NODE_WORDS, moved_children, node_words

RAY_SLOTS: tuple[Slot, ...] = (rows("ray_nodes"), rows("ray_triangles"), rows("ray_instances"))
"""What a pass with `//! use rays` binds beside its own; `RayScene.bound` are the values."""
MOST_STILL = 1 << 20
"""Triangles of still instances that are laid out in the world; further ones share geometries."""
INSTANCE_LEVELS = 10
_LOOSE = 2e-6  # of its farthest coordinate, by which an instance's box is wider than it
_ROWS = NODE_WORDS // 4  # of a node, and of a triangle


class RayScene:
    """The textures of RAY_SLOTS for the meshes of a `GpuScene`.

    A pass has `//! use rays` in its shader, RAY_SLOTS among its slots, `constants` among its own,
    and `bound` among the values that it is given. Instances and materials are numbered as in the
    GpuScene. Flattened instances that move are not hit.
    """

    def __init__(self, gpu: Gpu, scene: GpuScene) -> None:
        self.gpu, self._order = gpu, scene.order
        # What the scene shows at first, by instance.
        self._keys = [scene.first_vertices[index] for index in scene.order]
        self._first = [scene.original[index] for index in scene.order]
        self._masks = Masks(self._first, scene.material_rows)
        self._is_there = np.array([not is_gone(mesh.material) for mesh in self._first], bool)
        # One tree over all of it; meshes that move get their own when they do.
        self.still = StillTree(self._first, self._chosen(), self._masks.has_holes)
        self._in_still = np.isin(np.arange(len(self._keys)), self.still.instances)
        self.trees: dict[int, MeshTree] = {}
        self._with_holes = {
            key for key, hole in zip(self._keys, self._masks.has_holes, strict=True) if hole
        }
        # What lies in the textures.
        self._meshes: Sequence[Mesh] | None = None
        self._rooms: dict[int, int] = {}
        self._packed: tuple[bytes, ...] = ()
        self._rows: list[Rows] = []
        self._take(scene.current)

    @property
    def bound(self) -> dict[str, Any]:
        """The values of RAY_SLOTS."""
        names = [slot.name for slot in RAY_SLOTS]
        return dict(zip(names, self._rows, strict=True))

    @property
    def constants(self) -> dict[str, float]:
        """Constants of the pipelines that send rays; others once something has moved."""
        return {
            "RAYS_MEET_MASKS": float(self._masks.are_there),
            "RAYS_MEET_INSTANCES": float(bool(self.trees)),
        }

    @property
    def stats(self) -> dict[str, Any]:
        """Triangles in hierarchies, instances, and bytes on the device."""
        trees = [self.still.tree, *(tree.tree for tree in self.trees.values())]
        return {
            "triangles": sum(len(tree.order) for tree in trees),
            "instances": len(self._keys),
            "bytes": sum(rows.nbytes for rows in self._rows),
        }

    def update(self, scene: Scene) -> None:
        """Follow the meshes of `scene`: those of creation, as they are in this frame.

        What moved is uploaded before all that is submitted from here on.
        """
        if scene.meshes is not self._meshes:
            self._take(scene.meshes)

    def _chosen(self) -> list[int]:
        """The instances that are laid out in the world, as many as fit."""
        # From the first instance on, as long as they fit; further ones have trees of their own.
        counts = np.array([len(mesh.geometry.indices) for mesh in self._first], np.int64)
        counts[~self._is_there] = 0
        fits = (np.cumsum(counts) <= MOST_STILL) & self._is_there
        return [int(index) for index in np.flatnonzero(fits)]

    def _take(self, meshes: Sequence[Mesh]) -> None:
        """Show `meshes`, in the order of the scene."""
        self._meshes = meshes
        ordered = [meshes[index] for index in self._order]
        # Instances that moved leave the static tree, and are placed one by one.
        is_still = self._in_still & np.array(
            [_stands(mesh, first) for mesh, first in zip(ordered, self._first, strict=True)], bool
        )
        hidden = frozenset(np.flatnonzero(self._in_still & ~is_still).tolist())
        changed = {-1} if self.still.hide(hidden) else set()
        placed = np.flatnonzero(~is_still & self._is_there)
        changed |= self._grow({self._keys[i]: ordered[i] for i in placed})
        # Textures are made again where a tree is new or has outgrown its room.
        if (
            not self._rows
            or self.trees.keys() != self._rooms.keys() - {-1}
            or any(len(tree.nodes) > self._rooms[key] for key, tree in self.trees.items())
        ):
            self._lay()
            changed = {-1, *self.trees}
        for key in changed:
            self._write(key)
        self._place(ordered, placed)

    def _grow(self, shown: dict[int, Mesh]) -> set[int]:
        """Build the hierarchies of these geometries, or fit them; returns which changed."""
        changed = set()

        # A geometry's tree is built when an instance of it moves, and fitted when its vertices do.
        for key, mesh in shown.items():
            tree = self.trees.get(key)
            if tree is None:
                self.trees[key] = MeshTree(mesh.geometry, has_holes=key in self._with_holes)
                changed.add(key)
            elif tree.geometry is not mesh.geometry:
                tree.move(mesh.geometry)
                changed.add(key)
        return changed

    def _lay(self) -> None:
        """Make the textures: nodes of the instances, of the still ones, of each mesh; triangles."""
        # Where each tree begins, the static one first.
        node, triangle = len(self._keys) + 1, 0
        self._firsts: dict[int, tuple[int, int]] = {}
        self._rooms = {}
        shown: dict[int, StillTree | MeshTree] = {-1: self.still, **self.trees}
        for key, tree in shown.items():
            self._firsts[key], self._rooms[key] = (node, triangle), len(tree.nodes)
            node, triangle = node + len(tree.nodes), triangle + len(tree.tree.order)
        # Textures of that size replace the old ones.
        for old in self._rows:
            old.release()
        words = INSTANCE_WORDS * (len(self._keys) + 1) + self._masks.texels.size
        self._rows = [
            Rows(self.gpu, "ray nodes", _ROWS * node),
            Rows(self.gpu, "ray triangles", _ROWS * triangle),
            Rows(self.gpu, "ray instances", words // 4),
        ]
        self._packed = ()

    def _write(self, key: int) -> None:
        # Children count within a tree; in the texture they count from where it lies.
        tree = self.still if key == -1 else self.trees[key]
        node, triangle = self._firsts[key]
        words = tree.nodes.copy()
        words[:, 12:16] = moved_children(words[:, 12:16], node, triangle)
        self._rows[0].write(words, _ROWS * node)
        self._rows[1].write(tree.triangles, _ROWS * triangle)

    def _place(self, ordered: Sequence[Mesh], placed: NDArray[np.int64]) -> None:
        """Build the hierarchy over the instances that have moved, and all still ones."""
        # Each instance's row: transforms, and the first node of its geometry.
        count = len(self._keys)
        rows = self._masks.rows.copy()
        _put_transforms(rows, ordered)
        rows[:count, 24] = [self._firsts.get(key, (0, 0))[0] for key in self._keys]
        rows[count, 24] = rows[:, 34] = self._firsts[-1][0]

        # The same rows and boxes as before need no tree.
        low, high, items = self._boxes(ordered, placed)
        packed = (rows.tobytes(), low.tobytes(), high.tobytes())
        if packed == self._packed:
            return
        self._packed = packed
        self._rows[2].write(np.concatenate([rows.ravel(), self._masks.texels]))

        # One instance to a leaf.
        tree = build(low, high, most=1, levels=INSTANCE_LEVELS)
        lows, highs = child_boxes(tree, low[tree.order], high[tree.order])
        words = node_words(tree, lows, highs)
        # Leaves lead to instances themselves, not to a place in an order.
        is_leaf = tree.children >= LEAF
        words[:, 12:16][is_leaf] = LEAF | items[tree.order][tree.children[is_leaf] & INDEX_MASK]
        self._rows[0].write(words)

    def _boxes(self, ordered: Sequence[Mesh], placed: NDArray[np.int64]) -> tuple[F32, F32, U32]:
        """Boxes a little wider than what they are around, and their instances' rows."""
        shown = [int(i) for i in placed if _is_invertible(ordered[i].world_from_object)]
        boxes = world_boxes([ordered[i] for i in shown])
        # All static meshes are one more instance, laid out in the world.
        if len(self.still.bounds):
            corners = self.still.bounds
            whole = np.stack([corners.min(axis=0), corners.max(axis=0)])[None]
            boxes = np.concatenate([boxes, whole])
            shown.append(len(ordered))

        # Wider by what single precision may round off.
        wider = _LOOSE * np.abs(boxes).max(axis=(1, 2), initial=0.0)[:, None]
        low, high = boxes[:, 0] - wider, boxes[:, 1] + wider
        return low.astype(np.float32), high.astype(np.float32), np.array(shown, np.uint32)


def _stands(mesh: Mesh, first: Mesh) -> bool:
    """Whether a mesh is where it was at first."""
    return mesh.geometry is first.geometry and (
        mesh.world_from_object is first.world_from_object
        or np.array_equal(mesh.world_from_object, first.world_from_object)
    )


def _put_transforms(rows: U32, ordered: Sequence[Mesh]) -> None:
    """Object from world and world from object of each instance, and of the still ones."""
    floats = rows.view(np.float32)
    matrices = np.stack([*(mesh.world_from_object for mesh in ordered), np.eye(4)])
    floats[:, :12] = _inverses(matrices)[:, :3].reshape(-1, 12)
    floats[:, 12:24] = matrices[:, :3].reshape(-1, 12)


def _is_invertible(matrix: NDArray[np.float64]) -> bool:
    """Whether a transform leaves a volume, as single precision can tell."""
    # A determinant small beside the product of the columns' lengths is flat.
    sides = np.linalg.norm(matrix[:3, :3], axis=0).prod()
    return bool(abs(np.linalg.det(matrix[:3, :3])) > 1e-6 * sides)


def _inverses(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those of transforms (N, 4, 4); zero where there is none."""
    found = np.zeros_like(matrices)
    is_well = [_is_invertible(matrix) for matrix in matrices]
    found[is_well] = np.linalg.inv(matrices[is_well])
    return found
