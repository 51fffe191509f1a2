"""Mitsuba's grid volumes, .vol."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from .. import checks
from .dense_grid import DenseGrid, check_count
from .files import opened

_HEADER = struct.Struct("<3sBiiiii6f")
_FLOAT32 = 1


def read_vol(path: Path, grid: str) -> DenseGrid:
    """Mitsuba 3's grid volume: version 3, float32, x fastest, channels interleaved."""
    values, box = _read(path)
    return DenseGrid(values, checks.bounds((box[:3], box[3:]), "the bounding box in its header"))


def vol_values(path: Path) -> NDArray[np.float32]:
    """The values (z, y, x, channel) of such a file, wherever they lie. Raises SceneError."""
    return _read(path)[0]


def _read(path: Path) -> tuple[NDArray[np.float32], list[float]]:
    with opened(path) as stream:
        size_bytes = path.stat().st_size
        header = stream.read(_HEADER.size)
        if len(header) < _HEADER.size or not header.startswith(b"VOL"):
            raise SceneError("is not a Mitsuba volume: it does not start with 'VOL' and a header")
        _, version, encoding, nx, ny, nz, channel_count, *box = _HEADER.unpack(header)
        if version != 3 or encoding != _FLOAT32:
            raise SceneError(
                f"has version {version} and encoding {encoding}, only version 3 with encoding 1 "
                "(float32) is read"
            )
        if min(nx, ny, nz, channel_count) < 1:
            raise SceneError(f"has an impossible size {nx} x {ny} x {nz} x {channel_count}")
        # The size that the header asks for has to be the file's, to the byte.
        count = nx * ny * nz * channel_count
        check_count(count)
        if size_bytes != _HEADER.size + 4 * count:
            raise SceneError(
                f"has {size_bytes:,} bytes, its header of {nx} x {ny} x {nz} voxels and "
                f"{channel_count} channels needs {_HEADER.size + 4 * count:,}"
            )
        values = np.frombuffer(stream.read(4 * count), dtype="<f4")
    return values.reshape(nz, ny, nx, channel_count), box
