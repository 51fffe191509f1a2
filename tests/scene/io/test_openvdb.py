"""OpenVDB grids by tinyvdb: files written here byte by byte."""

from __future__ import annotations

import builtins
import struct

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.volumes import read_volume

pytestmark = pytest.mark.needs("tinyvdb")

SCALE_TRANSLATE = ("ScaleTranslateMap", (1.0, 2.0, 3.0))
TURNED = np.array([[0, 2, 0, 0], [-2, 0, 0, 0], [0, 0, 2, 0], [10, 20, 30, 1.0]])


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode()


def meta(entries: dict[str, str | int]) -> bytes:
    out = struct.pack("<I", len(entries))
    for key, value in entries.items():
        if isinstance(value, int):
            out += text(key) + text("int64") + struct.pack("<Iq", 8, value)
        else:
            out += text(key) + text("string") + text(value)
    return out


def only_first(count: int) -> bytes:
    return b"\1" + bytes(count // 8 - 1)


def internal(count: int) -> bytes:
    """An inner node whose first child there is, and no values."""
    return only_first(count) + bytes(count // 8) + b"\6" + bytes(4 * count)


def vdb_bytes(
    values,
    *,
    matrix=None,
    of_class="fog volume",
    background=0.0,
    tree="Tree_float_5_4_3",
    counted=None,
) -> bytes:
    """One leaf (8, 8, 8) at the origin; voxels of 0.5 m moved to (1, 2, 3), or `matrix`."""
    head = struct.pack("<qIII", 0x56444220, 224, 10, 0) + b"\1" + b"0" * 36
    head += meta({}) + struct.pack("<I", 1)
    described = text("density") + text(tree) + text("")
    at = len(head) + len(described) + 24
    body = struct.pack("<I", 0)
    body += meta({"class": of_class} | ({} if counted is None else {"file_voxel_count": counted}))
    if matrix is None:
        v = np.full(3, 0.5)
        rows = [np.array([1.0, 2.0, 3.0]), v, v, 1 / v, 1 / v**2, 0.5 / v]
        body += text("ScaleTranslateMap") + np.concatenate(rows).astype("<f8").tobytes()
    else:
        body += text("AffineMap") + matrix.astype("<f8").tobytes()
    body += struct.pack("<IfII3i", 1, background, 0, 1, 0, 0, 0)
    body += internal(32768) + internal(4096) + b"\xff" * 64
    block = at + len(body)
    body += b"\xff" * 64 + b"\6" + np.asarray(values, "<f4").tobytes()
    return head + described + struct.pack("<3q", at, block, at + len(body)) + body


COUNTED = np.arange(512, dtype=np.float32).reshape(8, 8, 8)


def test_a_fog_volume_is_read_where_it_is(tmp_path):
    (tmp_path / "a.vdb").write_bytes(vdb_bytes(COUNTED))
    grid = read_volume(tmp_path / "a.vdb", grid="whatever the only one is called")
    np.testing.assert_array_equal(grid.density, COUNTED.transpose(2, 1, 0))
    np.testing.assert_allclose(grid.bounds, ((0.75, 1.75, 2.75), (4.75, 5.75, 6.75)))
    np.testing.assert_array_equal(grid.world_from_volume, np.eye(4))


def test_a_turned_grid_keeps_its_matrix(tmp_path):
    (tmp_path / "a.vdb").write_bytes(vdb_bytes(COUNTED, matrix=TURNED))
    grid = read_volume(tmp_path / "a.vdb")
    assert grid.bounds == ((-0.5,) * 3, (7.5,) * 3)
    np.testing.assert_array_equal(grid.world_from_volume, TURNED.T)


def test_a_level_set_is_solid_beyond_its_narrow_band(tmp_path):
    x = np.arange(8.0)[:, None, None] + np.zeros((8, 8, 8))
    sdf = np.clip(0.5 * (np.abs(x - 4.0) - 2.5), -0.75, 0.75)
    sdf[x == 4.0] = 0.75  # as if no leaf said it
    content = vdb_bytes(sdf, of_class="level set", background=0.75)
    (tmp_path / "a.vdb").write_bytes(content)
    density = read_volume(tmp_path / "a.vdb").density
    np.testing.assert_allclose(density[0, 0], [0, 0, 1, 1, 1, 1, 1, 0], atol=1e-6)


@pytest.mark.parametrize("text", [b"density", b"fog volume", b"class"])
def test_texts_that_are_not_utf_8(tmp_path, text):
    good = vdb_bytes(COUNTED)
    assert text in good
    (tmp_path / "a.vdb").write_bytes(good.replace(text, text[:2] + b"\xff\xfe" + text[4:]))
    with pytest.raises(SceneError, match=r"a\.vdb: is not a readable \.vdb: .*(?i:utf-8)"):
        read_volume(tmp_path / "a.vdb")


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"abc" * 50, "is not a readable .vdb: Invalid VDB magic number"),
        (vdb_bytes(COUNTED)[:5000], "is not a readable .vdb: Grid byte offsets out of range"),
        (vdb_bytes(COUNTED, counted=1024), "holds 512 voxels in blocks of one value"),
        (vdb_bytes(COUNTED, tree="Tree_int32_5_4_3"), "only Tree_float_5_4_3 is read"),
    ],
)
def test_what_cannot_be_read_says_why(tmp_path, content, problem):
    (tmp_path / "a.vdb").write_bytes(content)
    with pytest.raises(SceneError) as caught:
        read_volume(tmp_path / "a.vdb")
    assert str(caught.value).startswith(f"{tmp_path / 'a.vdb'}: ")
    assert problem in str(caught.value)


def test_without_tinyvdb_the_extra_is_named(tmp_path, monkeypatch):
    def refuse(name, *args, **kwargs):
        if name == "tinyvdb":
            raise ImportError
        return real(name, *args, **kwargs)

    real = builtins.__import__
    monkeypatch.setattr(builtins, "__import__", refuse)
    (tmp_path / "a.vdb").write_bytes(b"")
    with pytest.raises(SceneError, match=r"Run: pip install 'airlight\[vdb\]'\."):
        read_volume(tmp_path / "a.vdb")
