"""Surfaces that are one although files cut them: meshes that glow alike and meet at edges."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..maths.weld import connected, edges_of, welded
from ..scene.checks import F64
from ..scene.material import Material
from ..scene.mesh import Geometry, Mesh, is_mirrored

_SAME = 2.0**-20  # of the meshes' extent: corners so near to each other meet
_MOST = 1 << 18  # triangles, of the smallest meshes first; what are more are no cut lights


class Part(NamedTuple):
    """A mesh's place in a surface `whole` of several, in the world: its `first` triangle there."""

    whole: Geometry
    first: int


def parts_of_wholes(meshes: Mapping[int, Mesh]) -> dict[int, Part]:
    """The parts of surfaces that several of these meshes make together, by the meshes' rows."""
    # Only meshes that glow alike, and alike all over, can be one surface; small ones come first.
    alike: dict[tuple[object, ...], list[int]] = {}
    for row in sorted(meshes, key=lambda row: len(meshes[row].geometry.indices)):
        if meshes[row].material.emission_texture is None:
            alike.setdefault(_glow(meshes[row].material), []).append(row)
    found = {}
    for rows in alike.values():
        # What meets is merged; each mesh remembers where its triangles begin in the whole.
        for whole in _meeting(rows, meshes):
            geometry, first = _merged([meshes[row] for row in whole]), 0
            for row in whole:
                found[row] = Part(geometry, first)
                first += len(meshes[row].geometry.indices)
    return found


def _glow(material: Material) -> tuple[object, ...]:
    """What is the same of meshes that are one light."""
    return (
        material.emission,
        material.two_sided,
        material.is_blended,
        material.alpha_cutoff,
        material.transmission,
    )


def _meeting(rows: list[int], meshes: Mapping[int, Mesh]) -> list[list[int]]:
    """Groups of several of these meshes, the smallest first, that share edges."""
    # Only as many triangles as a cut light would have.
    triangles = np.cumsum([len(meshes[row].geometry.indices) for row in rows])
    rows = rows[: int(np.searchsorted(triangles, _MOST, side="right"))]
    if len(rows) < 2:
        return []
    # All edges between numbers of places that several meshes may share.
    corners = [_placed(meshes[row]) for row in rows]
    placed = np.concatenate(corners)
    owner = np.repeat(np.arange(len(rows)), [3 * len(own) for own in corners])
    step = max(_SAME * float(np.ptp(placed, axis=(0, 1)).max()), 1e-30)
    numbers = welded(np.round(placed.reshape(-1, 3) / step)).reshape(-1, 3)
    _, edge = np.unique(edges_of(numbers), axis=0, return_inverse=True)
    # Meshes with an edge in common are joined.
    order = np.argsort(edge.reshape(-1), kind="stable")
    is_same = np.diff(edge.reshape(-1)[order]) == 0
    group = connected(len(rows), owner[order][:-1][is_same], owner[order][1:][is_same])
    wholes: dict[int, list[int]] = {}
    for row, own in sorted(zip(rows, group.tolist(), strict=True)):
        wholes.setdefault(own, []).append(row)
    return [whole for whole in wholes.values() if len(whole) > 1]


def _placed(mesh: Mesh) -> F64:
    """The corners (T, 3, 3) of a mesh's triangles, m, whose front is the mesh's."""
    # Mirrored meshes are wound the other way, so that their front stays.
    indices = mesh.geometry.indices
    return mesh.world_positions[indices[:, ::-1] if is_mirrored(mesh) else indices]


def _merged(meshes: Sequence[Mesh]) -> Geometry:
    """Their triangles in the world, one mesh's after the other's."""
    # Corners are not shared: touching meshes are found by place alone.
    corners = np.concatenate([_placed(mesh) for mesh in meshes]).reshape(-1, 3)
    indices = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
    return Geometry(corners.astype(np.float32), indices, np.zeros((len(corners), 3), np.float32))
