"""Groups of point lights: a `[[light]]` of type "points", its arrays in an .npz file."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import SceneError, nearest
from ..point_lights import PointLights
from .toml_meshes import existing_file
from .toml_schema import check_table
from .toml_tables import LIGHT

KIND = "points"
_ARRAYS = ("positions", "intensities")


def light_groups(tables: Iterable[tuple[str, Any]], folder: Path) -> tuple[PointLights, ...]:
    """The groups among the [[light]] tables (label, table). Raises SceneError."""
    return tuple(_group(label, table, folder) for label, table in tables if is_group(table))


def is_group(table: Any) -> bool:
    """Whether a [[light]] table is a group."""
    return isinstance(table, dict) and table.get("type") == KIND


def read_point_lights(path: Path) -> PointLights:
    """The arrays `positions` and `intensities` of an .npz file. Raises SceneError."""
    try:
        arrays = np.load(path, allow_pickle=False)
        if isinstance(arrays, np.ndarray):
            raise SceneError("holds one array, not the two of an .npz file", where=path)
        with arrays:
            found = {name: arrays[name] for name in arrays.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile):
        raise SceneError(
            "is not an .npz file of numbers", where=path,
            remedy="Write it with numpy.savez(file, positions=..., intensities=...).",
        ) from None  # fmt: skip
    for name in _ARRAYS:
        if name not in found:
            raise SceneError(f"has no array '{name}'", where=path, remedy=nearest(name, found))
    try:
        return PointLights(found["positions"], found["intensities"], source=path.name)
    except SceneError as error:
        raise SceneError(error.problem, where=path, remedy=error.remedy) from None


def _group(label: str, table: Any, folder: Path) -> PointLights:
    values = check_table(LIGHT, table, label)
    written = values["file"]
    return read_point_lights(existing_file(folder / written, written, label))
