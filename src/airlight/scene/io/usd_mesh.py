"""USD's meshes and simple shapes as triangles, cut by material."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from ...errors import SceneError
from ...maths.arrays import F32, F64, I64
from .. import shapes
from ..mesh import Geometry, smooth_normals, unit_or_up
from .normals import compact, creased_normals
from .polygons import triangulated


def prim_geometries(prim: Any, time: Any, uv_name: Any) -> Iterator[tuple[Geometry, Any]]:
    """(geometry, prim whose material it has) of a prim of which `is_shape` holds.

    `uv_name(prim)` names the texture coordinates of a prim's material. Raises SceneError.
    """
    from pxr import UsdGeom

    # A mesh in parts by material, or a shape of the size that its attributes say.
    if prim.IsA(UsdGeom.Mesh):
        mesh = UsdGeom.Mesh(prim)
        faces = _Faces(mesh, time)
        for chosen, bound in _subsets(prim, len(faces.sizes), time):
            chosen = np.setdiff1d(chosen, faces.holes)
            geometry = faces.geometry(chosen, uv_name(bound))
            if geometry is not None:
                yield geometry, bound
    elif prim.IsA(UsdGeom.Cube):
        yield _scaled(shapes.box(), (UsdGeom.Cube(prim).GetSizeAttr().Get(time),) * 3), prim
    elif prim.IsA(UsdGeom.Sphere):
        radius = UsdGeom.Sphere(prim).GetRadiusAttr().Get(time)
        yield _scaled(shapes.sphere(), (2.0 * radius,) * 3), prim
    elif prim.IsA(UsdGeom.Plane):
        plane = UsdGeom.Plane(prim)
        flat = (plane.GetWidthAttr().Get(time), 1.0, plane.GetLengthAttr().Get(time))
        yield _turned(_scaled(shapes.quad(), flat), str(plane.GetAxisAttr().Get(time))), prim
    else:
        yield _revolved(prim, time), prim


def is_shape(prim: Any) -> bool:
    """Whether a prim is a mesh, or a shape that becomes one."""
    return str(prim.GetTypeName()) in _SHAPES


def _revolved(prim: Any, time: Any) -> Geometry:
    """A Cylinder, Cone or Capsule, which have a radius, a height and an axis. Raises SceneError."""
    radius, height = (float(prim.GetAttribute(n).Get(time)) for n in ("radius", "height"))
    if not (0.0 < radius < np.inf and 0.0 <= height < np.inf):
        where = f"'{prim.GetPath()}'"
        raise SceneError(f"{where}: its radius {radius:g} and height {height:g} are no lengths")
    made = shapes.revolved(_PROFILES[str(prim.GetTypeName())](radius, height / 2.0))
    return _turned(made, str(prim.GetAttribute("axis").Get(time)))


_Lines = list[tuple[F64, F64]]
"""Points of a profile and their normals, as `shapes.revolved` takes them."""


def _straight(*ends: tuple[float, float]) -> _Lines:
    """From end to end, with an edge at each."""
    lines = []
    for start, end in pairwise(ends):
        points = np.array([start, end])
        along = points[1] - points[0]
        normal = np.array([along[1], -along[0]]) / max(float(np.linalg.norm(along)), 1e-30)
        lines.append((points, np.stack([normal, normal])))
    return lines


def _cylinder(radius: float, half: float) -> _Lines:
    return _straight((0.0, -half), (radius, -half), (radius, half), (0.0, half))


def _cone(radius: float, half: float) -> _Lines:
    return _straight((0.0, -half), (radius, -half), (0.0, half))


def _capsule(radius: float, half: float) -> _Lines:
    # One smooth line: a quarter of a circle at each end, the side between them.
    angles = np.linspace(-np.pi / 2.0, 0.0, 17)
    low = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    low[0, 0] = 0.0
    normals = np.concatenate([low, low[::-1] * (1.0, -1.0)])
    return [(normals * radius + np.where(normals[:, 1:] > 0.0, 1.0, -1.0) * (0.0, half), normals)]


_PROFILES = {"Cylinder": _cylinder, "Cone": _cone, "Capsule": _capsule}
_SHAPES = ("Mesh", "Cube", "Sphere", "Plane", *_PROFILES)


def _scaled(geometry: Geometry, size: tuple[float, ...]) -> Geometry:
    return replace(geometry, positions=geometry.positions * np.array(size, np.float32))


def _turned(geometry: Geometry, axis: str) -> Geometry:
    """A shape about +Y, about another axis."""
    order = {"X": [1, 2, 0], "Y": [0, 1, 2], "Z": [2, 0, 1]}[axis]
    assert geometry.normals is not None
    return replace(
        geometry, positions=geometry.positions[:, order], normals=geometry.normals[:, order]
    )


def _subsets(prim: Any, count: int, time: Any) -> Iterator[tuple[I64, Any]]:
    """Faces by the prim that says their material: GeomSubsets of the family materialBind."""
    from pxr import UsdShade

    # Faces that no subset claims have the mesh's own material.
    rest = np.ones(count, bool)
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        chosen = np.array(subset.GetIndicesAttr().Get(time) or [], np.int64)
        chosen = chosen[(chosen >= 0) & (chosen < count)]
        rest[chosen] = False
        yield chosen, subset.GetPrim()
    yield np.flatnonzero(rest), prim


class _Faces:
    """A mesh's polygons, and its values at their corners."""

    def __init__(self, mesh: Any, time: Any) -> None:
        self._mesh, self._time = mesh, time
        where = str(mesh.GetPath())
        # A mesh without points is empty; points of another type than the schema's are damage.
        points = mesh.GetPointsAttr().Get(time)
        has_points = points is not None and (not hasattr(points, "__len__") or len(points) > 0)
        positions = _table(points, 3) if has_points else np.zeros((0, 3))
        if positions is None:
            raise SceneError(f"'{where}': its points hold NaN or infinite numbers, or no positions")
        self.positions = positions
        self.sizes = _numbers(mesh.GetFaceVertexCountsAttr().Get(time), where)
        self.corners = _numbers(mesh.GetFaceVertexIndicesAttr().Get(time), where)
        # Damage is refused here, because later steps index by these numbers unchecked.
        if (self.sizes < 0).any() or int(self.sizes.sum()) != len(self.corners):
            raise SceneError(f"'{where}': its faces and their corners do not fit together")
        if len(self.corners) and not 0 <= self.corners.min() <= self.corners.max() < len(
            self.positions
        ):
            raise SceneError(f"'{where}': a face has a point that there is not")
        self.holes = np.array(mesh.GetHoleIndicesAttr().Get(time) or [], np.int64)
        # Faces go round clockwise where the mesh is left-handed.
        self._is_left_handed = mesh.GetOrientationAttr().Get(time) == "leftHanded"

    def geometry(self, chosen: I64, uv_name: str) -> Geometry | None:
        """The triangles of some faces; None where they have none."""
        # The chosen faces' corners, cut into triangles, in the mesh's own numbers.
        starts = np.cumsum(self.sizes) - self.sizes
        sizes = self.sizes[chosen]
        if int(sizes.sum()) == 0:
            return None
        first = np.repeat(starts[chosen] - (np.cumsum(sizes) - sizes), sizes)
        held = first + np.arange(int(sizes.sum()))  # the faces' corners, in the mesh's numbers
        at, polygon = triangulated(self.positions, self.corners[held], sizes)
        if len(at) == 0:
            return None
        at = held[at]
        # A left-handed mesh winds the other way.
        if self._is_left_handed:
            at = at[:, ::-1]
        # Rows of each table by its own interpolation: one vertex for each combination.
        face = np.asarray(chosen)[polygon]
        points = self.corners[at]
        normals, normal_at = self._normals(points, at, face)
        uvs, uv_at = self._primvar(uv_name, 2, points, at, face)
        colors, color_at = self._primvar("displayColor", 3, points, at, face)
        rows, indices = compact(np.stack([points, normal_at, uv_at, color_at], axis=-1))
        # Texture coordinates and colours only where the mesh has them.
        taken = {
            "normals": normals[rows[:, 1]].astype(np.float32),
            "uvs": None if uvs is None else _image_uvs(uvs[rows[:, 2]]),
            "colors": None if colors is None else _rgba(colors[rows[:, 3]]),
        }
        return Geometry(self.positions[rows[:, 0]].astype(np.float32), indices, **taken)

    def _normals(self, points: I64, at: I64, face: I64) -> tuple[F64, I64]:
        """A table of unit normals, and the row of each corner (T, 3)."""
        from pxr import UsdGeom

        rows: I64 | None
        # The primvar counts before the mesh's own attribute, as the schema says.
        found, rows = self._primvar("normals", 3, points, at, face)
        if found is None:
            found = _table(self._mesh.GetNormalsAttr().Get(self._time), 3)
            if found is not None:
                kind = str(self._mesh.GetNormalsInterpolation())
                rows = _rows(kind, len(found), None, points, at, face)
        if found is None or rows is None or rows.max() >= len(found):
            # A subdivided surface is smooth; others have the edges of what bends much.
            scheme = self._mesh.GetSubdivisionSchemeAttr().Get(self._time)
            if scheme != UsdGeom.Tokens.none:
                smooth = smooth_normals(self.positions.astype(np.float32), points.astype(np.uint32))
                return smooth.astype(np.float64), points
            table, index = creased_normals(self.positions, points)
            return table, np.asarray(index, np.int64)
        return unit_or_up(found), rows

    def _primvar(
        self, name: str, width: int, points: I64, at: I64, face: I64
    ) -> tuple[F64 | None, I64]:
        """Values of a primvar, and the row of each corner; None where it has none that fits."""
        from pxr import UsdGeom

        # Values are looked up along the tree, because a parent's constant primvar holds below it.
        none = np.full(points.shape, -1, np.int64)
        primvar = UsdGeom.PrimvarsAPI(self._mesh).FindPrimvarWithInheritance(name)
        values = primvar.Get(self._time) if primvar and primvar.HasValue() else None
        made = _table(values, width)
        if made is None:
            return None, none
        # An indexed primvar lists each value once, and says which one is where.
        index = primvar.GetIndices(self._time) if primvar.IsIndexed() else None
        kind = str(primvar.GetInterpolation())
        rows = _rows(kind, len(made), index, points, at, face)
        return (None, none) if rows is None else (made, rows)


def _rows(kind: str, count: int, index: Any, points: I64, at: I64, face: I64) -> I64 | None:
    """The row of each corner in a table of `count` values of an interpolation; None if too few."""
    given: dict[str, I64] = {
        "vertex": points,
        "varying": points,
        "faceVarying": at,
        "uniform": np.repeat(face[:, None], 3, axis=1),
        "constant": np.zeros(points.shape, np.int64),
    }
    # The interpolation says which number of a corner counts its values.
    rows = given.get(kind)
    if rows is None:
        return None
    # An index leads from the number to the row of values.
    if index is not None:
        table = np.array(index, np.int64)
        if rows.max() >= len(table):
            return None
        rows = table[rows]
    return rows if rows.min() >= 0 and rows.max() < count else None


def _table(values: Any, width: int) -> F64 | None:
    """An attribute's values (N, width), finite; None where it has none, or those of another type
    than its schema says."""
    try:
        made: F64 = np.array(values, np.float64)
    except (TypeError, ValueError):
        return None
    fits = made.ndim == 2 and made.shape[1] == width and len(made) > 0
    return made if fits and np.isfinite(made).all() else None


def _numbers(values: Any, where: str) -> I64:
    """Whole numbers of an attribute, in a row; none where it has none. Raises SceneError."""
    try:
        made = np.array([] if values is None else values)
        if made.ndim == 1 and (not made.size or np.issubdtype(made.dtype, np.integer)):
            return made.astype(np.int64)
    except (TypeError, ValueError):
        pass
    raise SceneError(f"'{where}': its faces are no whole numbers")


def _image_uvs(uvs: F64) -> F32:
    """USD's v runs upwards, airlight's downwards."""
    return np.stack([uvs[:, 0], 1.0 - uvs[:, 1]], axis=1).astype(np.float32)


def _rgba(colors: F64) -> F32:
    return np.concatenate([np.maximum(colors, 0.0), np.ones((len(colors), 1))], axis=1).astype(
        np.float32
    )
