"""Which axis of a density grid points upwards: what its file says, and what was asked for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..checks import F64
from .dense_grid import SAID, TAKEN
from .toml_meshes import upright_from_file
from .volumes import VolumeGrid


def upright_from_grid(
    values: Mapping[str, Any], grid: VolumeGrid, file: Path, *, is_bare: bool = False
) -> tuple[F64, tuple[str, ...]]:
    """(4, 4): the turn that the key `up` asks for of the `grid` in `file`, and what to tell.

    Where the file's axes say which way is up, there is none. Where it says nothing, and nobody
    asked, that is told of a grid that `is_bare`; scene files say it by the key.
    """
    asked = values.get("up")
    if grid.upright == SAID:
        told = f"{file.name}: up is left out: its own axes say which is up"
        return np.eye(4), (told,) if asked == "z" else ()
    # What was taken for the height, the first of the axes z, y, x, is up already: a turn back.
    if grid.upright == TAKEN:
        return upright_from_file({"up": "z"}).T if asked == "y" else np.eye(4), ()
    if asked is not None or not is_bare:
        return upright_from_file(values), ()
    told = f"{file.name} does not say which way is up: its y axis is taken as up and its z axis "
    return np.eye(4), (told + "as depth (--up z takes z as up)",)
