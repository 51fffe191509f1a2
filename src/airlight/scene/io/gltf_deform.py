"""Skins and morph targets of a glTF file (specification, sections 3.7.2.2 and 3.7.3)."""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..animation.skin import Morph, Shape, Skin, Vertices
from ..checks import F32, F64
from .gltf_buffers import Buffers
from .gltf_json import Item
from .gltf_mesh import Primitive

_MOST_SETS = 8  # of four joints a vertex each


class Deforms:
    """The deformed shapes of a document's meshes."""

    def __init__(self, document: Item, buffers: Buffers) -> None:
        self._buffers = buffers
        self._skins = document.items("skins")
        self._nodes = document.items("nodes")

    def shape(self, node: Item, primitive: Item, read: Primitive) -> Shape | None:
        """What deforms a primitive on a node; None where nothing does. Raises SceneError."""
        morph = self._morph(primitive, read)
        skin = self._skin(node, primitive, read)
        if morph is None and skin is None:
            return None
        # Flat normals follow from the deformed positions; the file's own are deformed too.
        geometry = read.geometry
        normals = None if read.is_flat else geometry.normals
        return Shape(Vertices(geometry.positions, normals, geometry.tangents), skin, morph)

    def weights(self, node: Item, mesh: Item, targets: int) -> F64:
        """The morph targets' weights (M,) at rest: the node's, else the mesh's, else 0."""
        for item in (node, mesh):
            if item.has("weights"):
                return np.array(item.floats("weights", targets, ()))
        return np.zeros(targets)

    def _morph(self, primitive: Item, read: Primitive) -> Morph | None:
        targets = primitive.items("targets")
        if not targets:
            return None
        # Vertices may have been split at creases; deltas follow them by the rows that they came
        # from.
        count = int(read.rows.max()) + 1
        deltas: dict[str, F32 | None] = {}
        for name in ("POSITION", "NORMAL", "TANGENT"):
            told = any(target.has(name) for target in targets)
            each = [self._deltas(target, name, count) for target in targets] if told else []
            deltas[name] = np.stack(each)[:, read.rows] if told else None
        positions = deltas["POSITION"]
        if positions is None:
            positions = np.zeros((len(targets), len(read.rows), 3), np.float32)
        return Morph(positions, deltas["NORMAL"], deltas["TANGENT"])

    # A target that lacks the attribute leaves it as it is.
    def _deltas(self, target: Item, name: str, count: int) -> F32:
        if not target.has(name):
            return np.zeros((count, 3), np.float32)
        deltas = self._buffers.array(target, name, width=3).astype(np.float32)
        if len(deltas) < count or not np.isfinite(deltas).all():
            raise target.child(name).error(f"has {len(deltas)} deltas for {count} vertices")
        return deltas[:count]

    def _skin(self, node: Item, primitive: Item, read: Primitive) -> Skin | None:
        # A skin acts on meshes that are bound to it by joints and weights alone.
        attributes = primitive.child("attributes")
        if not node.has("skin") or not attributes.has("JOINTS_0"):
            return None
        skin = self._skins[node.index("skin", self._skins, "skins")]
        joints = np.array([j.pick(self._nodes, "nodes") for j in skin.items("joints")], np.int64)
        if len(joints) == 0:
            raise skin.error("has no joints")
        influences, weights = self._influences(attributes, len(joints))
        # Each vertex that is drawn needs its joints.
        if len(influences) <= int(read.rows.max()):
            raise attributes.error(f"has joints for {len(influences)} vertices only")
        return Skin(
            joints,
            self._inverse_bind(skin, len(joints)),
            influences[read.rows],
            weights[read.rows],
        )

    def _inverse_bind(self, skin: Item, joints: int) -> F64:
        # Without matrices the vertices are in the joints' own spaces.
        if not skin.has("inverseBindMatrices"):
            return np.tile(np.eye(4), (joints, 1, 1))
        values = self._buffers.array(skin, "inverseBindMatrices", width=16)
        if len(values) < joints or not np.isfinite(values).all():
            raise skin.error(f"has {len(values)} inverse bind matrices for {joints} joints")
        # The file has each matrix by columns.
        return values[:joints].astype(np.float64).reshape(-1, 4, 4).transpose(0, 2, 1)

    def _influences(self, attributes: Item, joints: int) -> tuple[NDArray[np.int64], F32]:
        """Rows of the skin's joints (V, 4 n) and weights that sum to 1."""
        # Four joints and weights a vertex in each set, all sets side by side.
        sets = [k for k in range(_MOST_SETS) if attributes.has(f"JOINTS_{k}")]
        rows = [self._buffers.array(attributes, f"JOINTS_{k}", width=4) for k in sets]
        shares = [self._buffers.array(attributes, f"WEIGHTS_{k}", width=4) for k in sets]
        if len({len(a) for a in (*rows, *shares)}) != 1:
            raise attributes.error("its joints and weights differ in number")
        influences = np.concatenate(rows, axis=1).astype(np.int64)
        weights = np.concatenate(shares, axis=1).astype(np.float32)
        if influences.max() >= joints or influences.min() < 0:
            raise attributes.error(f"joint {influences.max()} is out of range: there are {joints}")
        # Weights as exporters round them need not add up to 1, and are scaled.
        total = weights.sum(axis=1, keepdims=True)
        if not np.isfinite(total).all() or (weights < 0.0).any():
            raise attributes.error("has weights that are negative, NaN or infinite")
        # A vertex of no weight stays with its first joint.
        weights[:, 0] = np.where(total[:, 0] > 0.0, weights[:, 0], 1.0)
        return influences, cast(F32, weights / weights.sum(axis=1, keepdims=True))
