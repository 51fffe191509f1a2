"""The invisible boundaries of media, and whether two of them cross."""

from __future__ import annotations

from itertools import combinations
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from ..errors import ReferenceFailure
from ..maths.transforms import placed_points, triple
from ..scene.checks import F64
from ..scene.volume import Volume
from .mitsuba_files import FileStore, write_ply
from .mitsuba_xml import add_matrix, add_reference, add_text, add_truth, plugin

EDGE_MARGIN = 1e-4  # of an extent: a boundary never lies in the plane of a surface
ELLIPSOID_STEPS = 128


def boundary(world_from_cube: F64, interior: str, exterior: str) -> Element:
    """A cube whose surface only parts two media."""
    shape = plugin("shape", "cube")
    add_matrix(shape, "to_world", world_from_cube)
    return _with_media(shape, interior, exterior)


def _with_media(shape: Element, interior: str, exterior: str) -> Element:
    shape.append(plugin("bsdf", "null"))
    add_reference(shape, interior, "interior")
    if exterior:
        add_reference(shape, exterior, "exterior")
    return shape


def ellipsoid(
    world_from_cube: F64, interior: str, exterior: str, files: FileStore, notes: list[str]
) -> Element:
    """A sphere where all axes are equal and at right angles, else a fine mesh of one."""
    # Mitsuba's sphere takes rotations and uniform scales alone: other ellipsoids become meshes.
    linear = world_from_cube[:3, :3]
    radius = float(np.cbrt(abs(np.linalg.det(linear))))
    if np.allclose(linear @ linear.T, radius**2 * np.eye(3), rtol=0.0, atol=1e-6 * radius**2):
        shape = plugin("shape", "sphere")
        add_matrix(shape, "to_world", world_from_cube)
        return _with_media(shape, interior, exterior)
    notes.append(f"{interior}: its ellipsoid is a mesh of {ELLIPSOID_STEPS} steps around")
    # A mirrored placement turns triangles inside out, and a boundary needs its outside.
    positions, indices = _unit_sphere(ELLIPSOID_STEPS)
    placed = (positions @ linear.T + world_from_cube[:3, 3]).astype(np.float32)
    if np.linalg.det(linear) < 0.0:
        indices = indices[:, ::-1]
    key = ("ellipsoid", interior)
    name = files.once(key, "boundary", "ply", lambda path: write_ply(path, placed, indices))
    shape = plugin("shape", "ply")
    add_text(shape, "filename", name)
    add_truth(shape, "face_normals", True)
    return _with_media(shape, interior, exterior)


def _unit_sphere(steps: int) -> tuple[F64, NDArray[np.uint32]]:
    """A latitude-longitude sphere, counter-clockwise outside, of the unit ball's volume."""
    # Rings of constant latitude around +y, then two triangles between neighbours on adjacent rings.
    rows = steps // 2
    theta, phi = np.linspace(0, np.pi, rows + 1), np.arange(steps) * (2 * np.pi / steps)
    ring = np.stack([np.cos(phi), np.zeros(steps), -np.sin(phi)], axis=1)
    positions = np.sin(theta)[:, None, None] * ring + np.cos(theta)[:, None, None] * (0, 1, 0)
    i, j = np.meshgrid(np.arange(rows), np.arange(steps), indexing="ij")
    a, b = i * steps + j, i * steps + (j + 1) % steps
    quads = np.stack([a, a + steps, b + steps, a, b + steps, b], axis=-1).reshape(-1, 3)

    # Inscribed triangles lose volume to the sphere; a little more radius gives it back.
    return positions.reshape(-1, 3) * (1.0 + 2.0 / steps**2), quads.astype(np.uint32)


def world_from_cube(low: F64, high: F64) -> F64:
    """Maps [-1, 1]^3 onto the box."""
    matrix = np.diag([*(0.5 * (high - low)), 1.0])
    matrix[:3, 3] = 0.5 * (low + high)
    return matrix


def world_from_volume_cube(volume: Volume, extent: float) -> F64:
    """Maps [-1, 1]^3 onto the placed volume, shrunk to `extent` of its size."""
    # Mitsuba's cube, placed as the volume's own box is.
    low, high = (np.array(corner) for corner in volume.bounds)
    shrink = np.diag([extent, extent, extent, 1.0])
    placed: F64 = volume.world_from_volume @ world_from_cube(low, high) @ shrink
    return placed


def holds(volume: Volume, point: F64) -> bool:
    """Whether a world point (m) is inside the volume, its thin margin left out."""
    matrix = world_from_volume_cube(volume, 1.0 - 2.0 * EDGE_MARGIN)
    local = np.linalg.solve(matrix, np.append(point, 1.0))[:3]
    if volume.shape == "sphere":
        return float(local @ local) < 1.0
    return bool(np.abs(local).max() < 1.0)


def _corners(volume: Volume) -> F64:
    # The eight signs: element 0 is the corner that the others at 1, 2 and 4 share an edge with.
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, 8).T
    matrix = world_from_volume_cube(volume, 1.0 - EDGE_MARGIN)
    return placed_points(signs, matrix)


def is_inside(volume: Volume, box: tuple[F64, F64]) -> bool:
    """Whether the whole placed volume lies in an upright box (corners, m)."""
    corners = _corners(volume)
    return bool((corners > box[0]).all() and (corners < box[1]).all())


def refuse_crossings(volumes: list[Volume], medium_extent: tuple[F64, F64] | None) -> None:
    """Raise ReferenceFailure where volumes overlap or cross the air's border."""

    def name(volume: Volume) -> str:
        return volume.source or f"volumes[{volumes.index(volume)}]"

    # Mitsuba's shapes switch media where a path crosses them: it loses track in overlapping ones.
    for first, second in combinations(volumes, 2):
        if _overlap(_corners(first), _corners(second)):
            raise ReferenceFailure(
                f"volumes {name(first)} and {name(second)} overlap, and Mitsuba knows one medium "
                "per point",
                remedy="Move them apart, or render them one at a time.",
            )

    # The medium of the scene ends at a box, and no volume may reach through it.
    if medium_extent is None:
        return
    box = Volume(
        sigma_t=(1, 1, 1),
        shape="box",
        bounds=(triple(medium_extent[0]), triple(medium_extent[1])),
    )
    for volume in volumes:
        if _overlap(_corners(volume), _corners(box)) and not is_inside(volume, medium_extent):
            raise ReferenceFailure(
                f"{name(volume)} reaches through the bounds of [medium], and Mitsuba knows one "
                "medium per point",
                remedy="Widen the medium's bounds, or leave them out.",
            )


def _overlap(first: F64, second: F64) -> bool:
    """Whether two parallelepipeds, 8 corners each, share inner points (separating axes)."""
    # Axes that can part two boxes: three face normals of each, and all products of their edges.
    edges = [corners[[1, 2, 4]] - corners[0] for corners in (first, second)]
    crosses = [np.cross(a, b) for group in edges for a, b in combinations(group, 2)]
    crosses += [np.cross(a, b) for a in edges[0] for b in edges[1]]

    # Products of parallel edges are no axis.
    for axis in crosses:
        if np.linalg.norm(axis) < 1e-12 * np.linalg.norm(edges[0][0]) ** 2:
            continue
        a, b = first @ axis, second @ axis
        if a.max() <= b.min() or b.max() <= a.min():
            return False
    return True
