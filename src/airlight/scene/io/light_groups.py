"""Groups of point lights: a `[[light]]` of type "points", its arrays in an .npz file."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ..point_lights import PointLights
from .files import naming
from .numpy_files import opened_npz
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
    with naming(path), opened_npz(path) as archive:
        positions, intensities = (archive.array(name) for name in _ARRAYS)
        return PointLights(positions, intensities, source=path.name)


def _group(label: str, table: Any, folder: Path) -> PointLights:
    # A group's keys are those of any [[light]]; all it says lies in its file.
    values = check_table(LIGHT, table, label)
    written = values["file"]
    return read_point_lights(existing_file(written, label, folder))
