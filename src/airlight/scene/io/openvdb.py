"""OpenVDB files (.vdb) by way of the package tinyvdb, the extra `vdb`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError, nearest
from ..checks import F32, F64
from .files import regular_file
from .nanovdb import SparseGrid, check_span
from .openvdb_counts import check_counts

_FLOAT_TREE = "Tree_float_5_4_3"
_AS_HALF = "_HalfFloat"


def read_openvdb(path: Path, wanted: str) -> SparseGrid:
    """The grid called `wanted`; the only one, where there is only one.

    Raises SceneError where it cannot be read, or tinyvdb is not there.
    """
    regular_file(path)  # what is no file is said before what is not installed
    try:
        import tinyvdb
    except ImportError:
        raise SceneError(
            ".vdb files need the package tinyvdb", remedy="Run: pip install 'airlight[vdb]'."
        ) from None
    check_counts(path)
    try:
        with tinyvdb.open(str(regular_file(path))) as opened:
            opened.read_grids()
            grids = [opened.grid(i) for i in range(opened.grid_count)]
            names = [grid.name for grid in grids]
            chosen = 0 if len(grids) == 1 else names.index(wanted) if wanted in names else -1
            if chosen < 0:
                raise SceneError(f"has no grid '{wanted}'", remedy=nearest(wanted, names))
            return _dense(grids[chosen], path.stat().st_size)
    except SystemError as error:  # tinyvdb's for metadata that Python cannot decode
        raise SceneError("is not a readable .vdb: a text in it is not UTF-8") from error
    except (tinyvdb.VDBError, ValueError) as error:  # ValueError: of names that are not UTF-8
        raise SceneError(f"is not a readable .vdb: {error}") from None


def _dense(grid: Any, file_bytes: int) -> SparseGrid:
    if grid.type_name.removesuffix(_AS_HALF) != _FLOAT_TREE:
        raise SceneError(f"holds a {grid.type_name}, only {_FLOAT_TREE} is read")
    box = grid.active_bbox()
    if box is None:
        raise SceneError("has no active voxels")
    low, high = (np.array(corner, dtype=np.int64) for corner in box)
    size = np.maximum(high - low, 0)
    check_span(size, file_bytes)
    # tinyvdb gives leaves alone: blocks of one value would be holes.
    missing = int(grid.metadata.get("file_voxel_count", 0)) - int(grid.active_voxel_count())
    if missing > 0:
        raise SceneError(
            f"holds {missing:,} voxels in blocks of one value, which tinyvdb leaves out",
            remedy="Convert it with nanovdb_convert to .nvdb.",
        )
    dense = grid.materialize_dense(tuple(low.tolist()), tuple(high.tolist()))
    values = np.frombuffer(dense.to_bytes(), np.float32).reshape(dense.shape, order="F")
    is_level_set = grid.metadata.get("class") == "level set"
    if is_level_set:
        values = _filled(values, float(grid.float_background()))
    x, y, z = low.tolist()
    return SparseGrid(values, (x, y, z), _matrix(grid.transform), is_level_set)


def _filled(distance: F32, background: float) -> F32:
    """Signed distances with the inside negative beyond the narrow band too, row by row in x."""
    is_band = np.abs(distance) < background
    row = np.where(is_band, np.arange(len(distance))[:, None, None], 0)
    before = np.take_along_axis(distance, np.maximum.accumulate(row, axis=0), axis=0)
    inside = ~is_band & (before < 0.0)
    return np.where(inside, np.float32(-background), distance)


def _matrix(transform: dict[str, Any]) -> F64:
    """(4, 4) world from index; tinyvdb gives rows of row vectors, or scale and translation."""
    if transform["type"] in ("affine", "unitary"):
        return np.asarray(transform["matrix"], dtype=np.float64).T
    matrix = np.eye(4)
    matrix[:3, :3] = np.diag(transform["scale"])
    matrix[:3, 3] = transform["translation"]
    return matrix
