"""[[volume]] tables without a grid: boxes, spheres, and what the meshes of a file enclose."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from ...errors import SceneError
from ..checks import F64
from ..volume import Volume
from .emission_files import taken_emission
from .toml_media_tables import SHAPES
from .toml_meshes import existing_file
from .toml_schema import inside


def shape_volume(
    values: dict[str, Any], matrix: F64, upright: F64, label: str, folder: Path
) -> tuple[Volume, tuple[str, ...]]:
    """The volume of density 1 that a table's `shape` describes, and what there is to tell of it.

    `matrix` (4, 4) places it; `upright` (4, 4) turns a mesh file's upwards axis to +Y before.
    Raises SceneError.
    """
    with inside(label):
        emission, _ = taken_emission(values, None, None)
    # Boxes and spheres look the same on each of their sides.
    if values["shape"] in SHAPES:
        with inside(label):
            return Volume(world_from_volume=matrix, emission=emission, **values), ()
    written = values.pop("shape")
    if "bounds" in values:
        raise SceneError(
            f"{label}: bounds are of a box, a sphere or a grid, not of the mesh '{written}'",
            remedy="It is where its file says; translate, rotate_deg and scale move it.",
        )
    return _in_file(written, values, matrix @ upright, label, folder, emission)


def _in_file(
    written: str, values: dict[str, Any], matrix: F64, label: str, folder: Path, emission: Any
) -> tuple[Volume, tuple[str, ...]]:
    """The volume that a mesh file's meshes enclose."""
    from . import load_meshes

    part = load_meshes(existing_file(written, label, folder))
    placed = [replace(m, world_from_object=matrix @ m.world_from_object) for m in part.meshes]
    with inside(f"{label}: '{written}'"):
        volume = Volume.in_meshes(placed, emission=emission, source=written, **values)
    told = list(part.warnings)
    if volume.body is not None and volume.body.holes:
        told.append(
            f"{label}: '{written}' is open: its medium ends at lids across its holes "
            f"({volume.body.holes})"
        )
    if part.animation is not None:
        told.append(f"{label}: '{written}' moves, its medium stands where the file begins")
    return volume, tuple(told)
