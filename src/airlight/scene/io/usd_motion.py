"""Transforms of a USD stage that move, as a rig of the prims' tree.

A moving transform is sampled at its own times and at every frame between, so that angles that go
beyond half a turn from one sample to the next turn as they do in USD.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...maths.transforms import trs_matrix
from ..animation.curve import Curve
from ..animation.rig import Clip, Part, Rig, Skeleton
from ..camera import Camera
from ..checks import F64
from ..lights import Light

STILL, _ROOT = 0, 1
_MOST_FRAMES = 4096
_SHEAR = 1e-3  # of a matrix's largest number: less than that is none


@dataclass(frozen=True, eq=False)
class Place:
    """Where something stands: `world` (4, 4) now, and the number of its node."""

    node: int
    world: F64


class UsdMotion:
    """The moving transforms of a stage that `root` (4, 4) places; `time` is what is shown at rest.

    Seconds count from `time`, or from the first sample of all. `warnings` say what cannot be shown.
    """

    def __init__(self, stage: Any, root: F64, time: Any) -> None:
        self._time, self.warnings = time, list[str]()
        self._rate = float(stage.GetTimeCodesPerSecond()) or 24.0
        # Nodes by number: what their place on their parent is, or its samples by time code.
        self._order = [(STILL, -1), (_ROOT, -1)]
        self._matrix = {STILL: np.eye(4), _ROOT: root}
        self._samples: dict[int, tuple[list[float], tuple[F64, F64, F64]]] = {}
        self._nodes: dict[str, int] = {}
        self._moving: dict[str, bool] = {"/": False}

    def place(self, prim: Any, world: F64) -> Place:
        """Of a prim that stands at `world` (4, 4) now."""
        return Place(self._node(prim) if self._moves(prim) else STILL, world)

    def left_still(self, prim: Any) -> None:
        """Tell of a prim that moves and is static here: volumes, domes, what is instanced."""
        if self._moves(prim):
            self.warnings.append(f"'{prim.GetPath()}': a {prim.GetTypeName()} that moves is static")

    def rig(
        self,
        meshes: Sequence[Place],
        lights: Sequence[tuple[Place, Light]],
        camera: tuple[Place, Camera] | None,
    ) -> Rig | None:
        """What moves, in the order of the scene's meshes and lights; None where nothing does.

        Lights and camera are in the world, where they stand now.
        """
        held = [*meshes, *(place for place, _ in lights), *([camera[0]] if camera else [])]
        if all(place.node == STILL for place in held):
            return None
        parts = tuple(Part(p.node, local=p.world if p.node == STILL else None) for p in meshes)
        hung = tuple((self._from_now(place), light) for place, light in lights)
        seen = (self._from_now(camera[0]), camera[1]) if camera else None
        if seen and seen[0] == STILL:
            seen = None
        return Rig(self._skeleton(), parts, hung, seen, (self._clip(),))

    def _moves(self, prim: Any) -> bool:
        """Whether a prim's place changes, by its own transform or by those around it."""
        from pxr import UsdGeom

        path = str(prim.GetPath())
        if path not in self._moving:
            own = UsdGeom.Xformable(prim) if prim.IsA(UsdGeom.Xformable) else None
            is_varying = self._has_samples(own, path)
            is_apart = own is not None and own.GetResetXformStack()
            self._moving[path] = is_varying or (not is_apart and self._moves(prim.GetParent()))
        return self._moving[path]

    def _has_samples(self, own: Any, path: str) -> bool:
        """Whether an Xformable, or None, has samples of its own place over time."""
        if own is None or not own.TransformMightBeTimeVarying():
            return False
        is_sampled = len(own.GetTimeSamples()) > 0
        told = f"'{path}': its motion is no time samples (splines are left out)"
        if not is_sampled and told not in self.warnings:
            self.warnings.append(told)
        return is_sampled

    def _node(self, prim: Any) -> int:
        """The number of a prim's node; its parents have theirs before."""
        from pxr import UsdGeom

        path = str(prim.GetPath())
        if path == "/":
            return _ROOT
        if path in self._nodes:
            return self._nodes[path]
        # A prim that resets the stack of transforms stands in the stage, not in its parent.
        own = UsdGeom.Xformable(prim) if prim.IsA(UsdGeom.Xformable) else None
        is_apart = own is not None and own.GetResetXformStack()
        parent = _ROOT if is_apart else self._node(prim.GetParent())
        number = self._add(parent, _local(own, self._time))
        self._nodes[path] = number
        # Matrices are taken apart: a rig turns, scales and shifts, and cannot shear.
        if self._has_samples(own, path):
            codes = self._codes(own)
            matrices = np.array([_local(own, code) for code in codes])
            self._samples[number] = codes, _parts(matrices)
            if _shear(self._samples[number][1], matrices):
                self.warnings.append(f"'{path}': its motion shears, which is left out")
        return number

    def _add(self, parent: int, matrix: F64) -> int:
        number = len(self._order)
        self._order.append((number, parent))
        self._matrix[number] = matrix
        return number

    def _from_now(self, place: Place) -> int:
        """A node by which what is in the world now moves with the place."""
        if place.node == STILL:
            return STILL
        # What is scaled to nothing now has no place to go on from.
        if np.linalg.matrix_rank(place.world) < 4:
            self.warnings.append("a light or camera is scaled to nothing at first: it stays there")
            return STILL
        return self._add(place.node, np.asarray(np.linalg.inv(place.world), np.float64))

    def _codes(self, own: Any) -> list[float]:
        """Its samples' time codes, and every frame between them."""
        samples = [float(code) for code in own.GetTimeSamples()]
        frames = int(np.clip(np.ceil(samples[-1] - samples[0]), 0, _MOST_FRAMES))
        between = np.linspace(samples[0], samples[-1], frames + 1)
        found = np.unique(np.round(np.append(between, samples), 6))
        return [float(code) for code in found]

    def _skeleton(self) -> Skeleton:
        count = len(self._order)
        turns = np.tile((0.0, 0.0, 0.0, 1.0), (count, 1))
        t, s = np.zeros((count, 3)), np.ones((count, 3))
        for node in self._samples:
            (t[node],), (turns[node],), (s[node],) = _parts(self._matrix[node][None])
        still = {node: m for node, m in self._matrix.items() if node not in self._samples}
        return Skeleton(tuple(self._order), t, turns, s, still)

    def _clip(self) -> Clip:
        earliest = min(codes[0] for codes, _ in self._samples.values())
        start = earliest if self._time.IsEarliestTime() else float(self._time.GetValue())
        channels = {}
        for node, (codes, parts) in self._samples.items():
            times = (np.array(codes) - start) / self._rate
            for path, values in zip(("translation", "rotation", "scale"), parts, strict=True):
                between = "slerp" if path == "rotation" else "linear"
                channels[node, path] = Curve(times, values, between)
        return Clip("motion", channels, {})


def _local(own: Any, time: Any) -> F64:
    """(4, 4) of an Xformable at a time; of None, a prim without a place, the identity."""
    if own is None:
        return np.eye(4)
    # USD multiplies row vectors, hence the transposed matrix.
    return np.asarray(np.array(own.GetLocalTransformation(time)).T, np.float64)


def _shear(parts: tuple[F64, F64, F64], matrices: F64) -> bool:
    """Whether some matrices (K, 4, 4) are not their translation, rotation and scale."""
    off = np.abs(trs_matrix(*parts) - matrices).max(axis=(1, 2))
    return bool((off > _SHEAR * np.abs(matrices[:, :3, :3]).max(axis=(1, 2))).any())


def _parts(matrices: F64) -> tuple[F64, F64, F64]:
    """Translations (K, 3), rotations (K, 4) xyzw and scales (K, 3) of matrices (K, 4, 4).

    A mirrored one has a scale below 0 along x.
    """
    scales = np.linalg.norm(matrices[:, :3, :3], axis=1)
    turns = matrices[:, :3, :3] / np.maximum(scales, 1e-30)[:, None, :]
    # Axes of no length say nothing of a rotation.
    turns[scales.min(axis=1) <= 1e-12] = np.eye(3)
    is_mirrored = np.linalg.det(turns) < 0.0
    turns[is_mirrored, :, 0] *= -1.0
    scales[is_mirrored, 0] *= -1.0
    return matrices[:, :3, 3], _quaternions(turns), scales


def _quaternions(turns: F64) -> F64:
    """xyzw (K, 4) of rotations (K, 3, 3): the eigenvectors of Bar-Itzhack's symmetric matrices, so
    that a rotation with errors has the nearest one."""
    m = turns.transpose(1, 2, 0)
    k = np.zeros((4, 4, len(turns)))
    k[0, 0] = m[0, 0] - m[1, 1] - m[2, 2]
    k[1, :2] = m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2]
    k[2, :3] = m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1]
    k[3, :3] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    k[3, 3] = m[0, 0] + m[1, 1] + m[2, 2]
    _, vectors = np.linalg.eigh(k.transpose(2, 0, 1))  # of the lower triangles
    return np.asarray(vectors[:, :, -1], np.float64)
