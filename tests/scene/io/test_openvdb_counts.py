"""What a damaged OpenVDB file claims is held to its size before tinyvdb allocates it."""

from __future__ import annotations

import re
import struct

import pytest

from airlight.errors import SceneError
from airlight.scene.io.openvdb_counts import check_counts

from .test_openvdb import COUNTED, TURNED, vdb_bytes

GRIDS_AT = 61
SCALED, TURNED_GRID = vdb_bytes(COUNTED), vdb_bytes(COUNTED, matrix=TURNED)


def root_at(raw: bytes) -> int:
    """Where a root's number of tiles stands: behind where the grid is, buffers and background."""
    if b"AffineMap" in raw:
        return raw.index(b"AffineMap") + len(b"AffineMap") + 16 * 8 + 8
    return raw.index(b"ScaleTranslateMap") + len(b"ScaleTranslateMap") + 18 * 8 + 8


def claiming(raw: bytes, at: int, count: int) -> bytes:
    return raw[:at] + struct.pack("<I", count) + raw[at + 4 :]


@pytest.mark.parametrize(
    ("raw", "told"),
    [
        (claiming(SCALED, GRIDS_AT, 4_186_112), "4,186,112 grids"),
        (claiming(SCALED, GRIDS_AT, 5_000), "5,000 grids"),
        (claiming(SCALED, root_at(SCALED), 20_000_000), "20,000,000 tiles"),
        (claiming(TURNED_GRID, root_at(TURNED_GRID), 20_000_000), "20,000,000 tiles"),
        (claiming(SCALED, root_at(SCALED) + 4, 20_000_000), "20,000,000 nodes"),
    ],
)
def test_counts_that_the_size_cannot_justify(tmp_path, raw, told):
    path = tmp_path / "a.vdb"
    path.write_bytes(raw)
    with pytest.raises(SceneError, match=rf"{re.escape(told)} do not fit in [\d,]+ bytes"):
        check_counts(path)


@pytest.mark.parametrize(
    "raw",
    [
        SCALED,
        TURNED_GRID,
        b"",
        b"abc" * 50,
        SCALED[:60],
        SCALED[:400],
        claiming(SCALED, 57, 3),
        claiming(SCALED, 65, 1 << 31),
        claiming(SCALED, 8, 221),
    ],
)
def test_all_else_is_left_to_tinyvdb(tmp_path, raw):
    path = tmp_path / "a.vdb"
    path.write_bytes(raw)
    check_counts(path)
