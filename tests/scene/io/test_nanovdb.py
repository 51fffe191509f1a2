"""NanoVDB grids: a tree written here, a level set that others wrote, and damaged files."""

from __future__ import annotations

import struct
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.nanovdb import read_nanovdb
from airlight.scene.io.volumes import read_volume

ROCKS = Path(__file__).parents[3] / "../shared/data/volume/rocks.nvdb"
NAME = b"density\0"
FIRST, LAST = (-3, 2, 120), (6, 9, 139)


def leaf(low, values) -> bytes:
    node = np.zeros(2144, np.uint8)
    node[:12] = np.array(low, "<i4").view(np.uint8)
    node[96:] = np.asarray(values, "<f4").ravel().view(np.uint8)
    return node.tobytes()


def inner(low, side: int, table_at: int, values: dict[tuple[int, int, int], float]) -> bytes:
    table = np.zeros((side, side, side), "<i8")
    for place, value in values.items():
        table[place] = np.array([value, 0.0], "<f4").view("<i8")[0]
    return np.array(low, "<i4").tobytes() + bytes(table_at - 12) + table.tobytes()


def tree() -> tuple[bytes, list[int], list[int]]:
    """Nodes root first, where each kind begins (leaf, lower, upper, root), how many there are.

    Leaves at (-8, 0, 120) and (0, 0, 128); a tile of 5 at (0, 8, 128), 8 voxels across.
    """
    x = np.arange(512, dtype=np.float32).reshape(8, 8, 8)
    leaves = leaf((-3, 2, 120), x) + leaf((0, 2, 128), 1000.0 + x)
    lowers = inner((-3, 2, 120), 16, 1088, {}) + inner((0, 2, 130), 16, 1088, {(0, 1, 0): 5.0})
    uppers = inner((-3, 2, 120), 32, 8256, {}) + inner((0, 2, 130), 32, 8256, {})
    root = bytes(24) + struct.pack("<If", 0, -1.0) + bytes(32)
    parts = [root, uppers, lowers, leaves]
    at = np.cumsum([64, *(len(p) for p in parts)])
    return b"".join(parts), [int(at[k]) for k in (3, 2, 1, 0)], [2, 2, 2]


def nvdb_bytes(
    *, packed=True, kind=1, codec=None, version=(32 << 21) + (6 << 10), grid_class=2
) -> bytes:
    nodes, offsets, counts = tree()
    head = bytearray(672)
    half = np.array([[0.5, 0, 0], [0, 0.25, 0], [0, 0, 1.0]])
    head[296 + 88 : 296 + 88 + 72] = half.astype("<f8").tobytes()
    head[296 + 232 : 296 + 256] = np.array([10.0, 20.0, 30.0], "<f8").tobytes()
    sizes = struct.pack("<4q3I", *offsets, *counts) + bytes(20)
    buffer = bytes(head) + sizes + nodes
    body = struct.pack("<Q", 0) + zlib.compress(buffer) if packed else buffer
    codec = int(packed) if codec is None else codec
    record = struct.pack(
        "<4Q2I6d6i3dI4I3I2HI",
        len(buffer),
        len(body),
        0,
        0,
        kind,
        grid_class,
        *[0.0] * 6,
        *FIRST,
        *LAST,
        1.0,
        1.0,
        1.0,
        len(NAME),
        0,
        0,
        0,
        0,
        0,
        0,
        0,
        codec,
        0,
        version,
    )
    return struct.pack("<8sIHH", b"NanoVDB0", version, 1, codec) + record + NAME + body


@pytest.mark.parametrize("packed", [True, False])
def test_leaves_tiles_and_background_are_spread(tmp_path, packed):
    (tmp_path / "a.nvdb").write_bytes(nvdb_bytes(packed=packed))
    grid = read_nanovdb(tmp_path / "a.nvdb", "density")
    assert grid.first == FIRST
    assert grid.values.shape == (10, 8, 20)
    at = dict(np.ndenumerate(grid.values))
    assert at[0, 0, 0] == 64 * 5 + 8 * 2  # voxel (-3, 2, 120) of the leaf at (-8, 0, 120)
    assert at[3, 0, 8] == 1000 + 16  # (0, 2, 128)
    assert at[9, 6, 8] == at[3, 7, 15] == 5.0  # (6, 8, 128), (0, 9, 135): the tile
    assert at[9, 7, 19] == -0.0 or at[9, 7, 19] == 0.0  # a lower node's inactive value
    assert at[0, 6, 8] == 0.0  # (-3, 8, 128)


def blosc_bytes(*, chunk: int, flipped: int | None = None) -> bytes:
    """The same file with its grid in chunks of c-blosc, as nanovdb/io/IO.h writes them."""
    import blosc

    plain = nvdb_bytes(packed=False)
    start = struct.calcsize("<8sIHH") + struct.calcsize("<4Q2I6d6i3dI4I3I2HI") + len(NAME)
    buffer, body = plain[start:], b""
    for at in range(0, len(buffer), chunk):
        one = blosc.compress(buffer[at : at + chunk], typesize=4, clevel=9, cname="lz4")
        body += struct.pack("<Q", len(one)) + one
    head = bytearray(plain[:start])
    struct.pack_into("<H", head, 14, 2)
    struct.pack_into("<Q", head, 24, len(body))
    struct.pack_into("<H", head, start - len(NAME) - 8, 2)
    if flipped is not None:
        body = body[:flipped] + bytes([body[flipped] ^ 0x55]) + body[flipped + 1 :]
    return bytes(head) + body


@pytest.mark.needs("blosc")
def test_blosc_is_unpacked_chunk_by_chunk(tmp_path):
    (tmp_path / "a.nvdb").write_bytes(blosc_bytes(chunk=100_000))
    (tmp_path / "b.nvdb").write_bytes(nvdb_bytes())
    got, want = (read_nanovdb(tmp_path / name, "density") for name in ("a.nvdb", "b.nvdb"))
    np.testing.assert_array_equal(got.values, want.values)


@pytest.mark.parametrize("byte", [0, 12, 13, 20, 24])
@pytest.mark.needs("blosc")
def test_damaged_blosc_says_so(tmp_path, byte):
    """A length, the unpacked size, the packed size, and where blocks start."""
    (tmp_path / "a.nvdb").write_bytes(blosc_bytes(chunk=1 << 30, flipped=byte))
    with pytest.raises(SceneError) as caught:
        read_volume(tmp_path / "a.nvdb")
    assert "a.nvdb: is damaged" in str(caught.value)


def test_without_blosc_it_says_what_to_install(tmp_path, monkeypatch):
    (tmp_path / "a.nvdb").write_bytes(nvdb_bytes(codec=2))
    monkeypatch.setitem(sys.modules, "blosc", None)
    with pytest.raises(SceneError) as caught:
        read_volume(tmp_path / "a.nvdb")
    assert "needs the package blosc. Run: pip install 'airlight[vdb]'" in str(caught.value)


def test_its_place_is_read_and_negative_density_refused(tmp_path):
    (tmp_path / "a.nvdb").write_bytes(nvdb_bytes())
    grid = read_volume(tmp_path / "a.nvdb")
    # Voxel centres lie at whole numbers: the box reaches half a voxel further.
    np.testing.assert_allclose(grid.bounds[0], (10 - 3.5 * 0.5, 20 + 1.5 * 0.25, 30 + 119.5))
    np.testing.assert_allclose(grid.bounds[1], (10 + 6.5 * 0.5, 20 + 9.5 * 0.25, 30 + 139.5))
    assert grid.density.shape == (20, 8, 10)
    assert grid.density[8, 6, 9] == 5.0


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"NanoVDB", "is not a NanoVDB file"),
        (b"VDB \0\0\0\0" * 9, "is not a NanoVDB file"),
        (nvdb_bytes()[:100], "is damaged: unpack_from requires a buffer of at least 192 bytes"),
        (nvdb_bytes()[:900], "is cut short"),
        (nvdb_bytes(packed=False)[:9000], "is cut short"),
        (nvdb_bytes(codec=3), "is packed by a codec that is not known, 3"),
        (nvdb_bytes(kind=13), "holds values of NanoVDB's type 13, only 32-bit floats are read"),
        (nvdb_bytes(version=29 << 21), "is of NanoVDB version 29, only 32 is read"),
    ],
)
def test_what_cannot_be_read_says_why(tmp_path, content, problem):
    (tmp_path / "a.nvdb").write_bytes(content)
    with pytest.raises(SceneError) as caught:
        read_volume(tmp_path / "a.nvdb")
    assert f"a.nvdb: {problem}" in str(caught.value)


def test_rocks_are_a_solid():
    if not ROCKS.exists():
        pytest.skip("the shared rocks.nvdb is not there")
    sdf = read_nanovdb(ROCKS, "surface")
    assert sdf.is_level_set
    assert sdf.values.shape == (194, 63, 157)
    near = np.abs(sdf.values) < 0.3
    slope = np.linalg.norm(np.stack(np.gradient(sdf.values, 0.2)), axis=0)[near]
    assert np.median(slope) == pytest.approx(1.0, abs=0.01)  # a signed distance
    grid = read_volume(ROCKS)
    assert (grid.density.min(), grid.density.max()) == (0.0, 1.0)
    np.testing.assert_allclose(grid.bounds, ((-19.3, -1.1, -15.7), (19.5, 11.5, 15.7)), atol=1e-6)
    # The ground's side is solid, the sky's is not.
    assert grid.density[:, :8].mean() > 0.3 > 0.05 > grid.density[:, -8:].mean()
