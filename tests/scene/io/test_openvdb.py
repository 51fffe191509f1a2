"""OpenVDB grids: files written here byte by byte, by the library's own file format."""

from __future__ import annotations

import builtins
import re
import struct
import zlib

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io import load
from airlight.scene.io.volumes import read_values, read_volume

TURNED = np.array([[0, 2, 0, 0], [-2, 0, 0, 0], [0, 0, 2, 0], [10, 20, 30, 1.0]])
COUNTED = np.arange(512, dtype=np.float32).reshape(8, 8, 8)
GRIDS_AT = 61
ZIP, ACTIVE_MASK, BLOSC = 1, 2, 4


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode()


def meta(entries: dict[str, str]) -> bytes:
    out = struct.pack("<I", len(entries))
    for key, value in entries.items():
        out += text(key) + text("string") + text(value)
    return out


def bits(count: int, on: tuple[int, ...] = ()) -> bytes:
    mask = np.zeros(count, bool)
    mask[list(on)] = True
    return np.packbits(mask, bitorder="little").tobytes()


def packed(raw: bytes, compression: int) -> bytes:
    if not compression & (ZIP | BLOSC):
        return raw
    if compression & BLOSC:
        import blosc

        small = blosc.compress(raw, typesize=4) if raw else b""
    else:
        small = zlib.compress(raw)
    if len(small) < len(raw):
        return struct.pack("<q", len(small)) + small
    return struct.pack("<q", -len(raw)) + raw


def inner(count: int, compression: int, dtype: str, tiles, active, width: int = 1) -> bytes:
    """An inner node: its first child is there, and the tiles by offset."""
    values = np.zeros((count, width), dtype)
    values[list(tiles)] = np.reshape(list(tiles.values()), (-1, 1))
    stored = packed(values.tobytes(), compression)
    return bits(count, (0,)) + bits(count, active) + b"\6" + stored


def leaf_values(values, compression: int, kind: int, dtype: str, inactive=()) -> bytes:
    """A leaf's mask and values; `kind` says what its inactive ones are, where they are zero."""
    values = np.asarray(values).reshape(512, -1)
    on = np.ones(512, bool) if kind == 6 else (values != 0).any(axis=1)
    stored = values[on] if compression & ACTIVE_MASK and kind != 6 else values
    head = np.packbits(on, bitorder="little").tobytes() + struct.pack("<b", kind)
    return head + b"".join(inactive) + packed(stored.astype(dtype).tobytes(), compression)


def vdb_bytes(
    values,
    *,
    matrix=None,
    of_class="fog volume",
    background=0.0,
    tree="Tree_float_5_4_3",
    compression=0,
    kind=6,
    inactive=(),
    tiles=None,
    active=(),
    version=224,
    instance=False,
) -> bytes:
    """One leaf (8, 8, 8) at the origin; voxels of 0.5 m moved to (1, 2, 3), or `matrix`.

    `tiles`: values of the lower inner node by offset, of which `active` are; `instance`: a
    second grid that shows the same tree 100 m to the right.
    """
    head = struct.pack("<qIII", 0x56444220, version, 10, 0) + b"\1" + b"0" * 36
    head += meta({}) + struct.pack("<I", 2 if instance else 1)
    described = text("density") + text(tree) + text("")
    at = len(head) + len(described) + 24
    body = struct.pack("<I", compression) + meta({"class": of_class})
    if matrix is None:
        v = np.full(3, 0.5)
        rows = [np.array([1.0, 2.0, 3.0]), v, v, 1 / v, 1 / v**2, 0.5 / v]
        body += text("ScaleTranslateMap") + np.concatenate(rows).astype("<f8").tobytes()
    else:
        body += text("AffineMap") + matrix.astype("<f8").tobytes()
    width = 3 if "vec3" in tree else 1
    body += struct.pack(f"<I{width}fII3i", 1, *[background] * width, 0, 1, 0, 0, 0)
    dtype = "<f2" if tree.endswith("_HalfFloat") else "<f4"
    body += inner(32768, compression, dtype, {}, (), width)
    body += inner(4096, compression, dtype, tiles or {}, active, width)
    on = np.ones(512, bool)
    if kind != 6:
        on = (np.asarray(values).reshape(512, -1) != 0).any(axis=1)
    body += np.packbits(on, bitorder="little").tobytes()
    block = at + len(body)
    body += leaf_values(values, compression, kind, dtype, inactive)
    end = at + len(body)
    whole = head + described + struct.pack("<3q", at, block, end) + body
    if instance:
        named = text("copy") + text(tree) + text("density")
        begin = end + len(named) + 24
        placed = struct.pack("<I", 0) + meta({}) + text("TranslationMap")
        placed += struct.pack("<3d", 100.0, 0.0, 0.0)
        whole += named + struct.pack("<3q", begin, begin, begin + len(placed)) + placed
    return whole


def read(tmp_path, raw: bytes, grid: str = "density"):
    (tmp_path / "a.vdb").write_bytes(raw)
    return read_volume(tmp_path / "a.vdb", grid=grid)


def test_a_fog_volume_is_read_where_it_is(tmp_path):
    (tmp_path / "a.vdb").write_bytes(vdb_bytes(COUNTED))
    grid = read_volume(tmp_path / "a.vdb", grid="whatever the only one is called")
    np.testing.assert_array_equal(grid.density, COUNTED.transpose(2, 1, 0))
    np.testing.assert_allclose(grid.bounds, ((0.75, 1.75, 2.75), (4.75, 5.75, 6.75)))
    np.testing.assert_array_equal(grid.world_from_volume, np.eye(4))


@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("mask", [0, ACTIVE_MASK])
def test_a_grid_of_vectors_is_read_with_its_channels(tmp_path, mask, half):
    """`Cd`, as others write colours: three numbers a voxel, in tiles too."""
    colours = np.stack([SPARSE, np.roll(SPARSE, 7) / 2.0, 0.0 * SPARSE], axis=-1)
    tree = "Tree_vec3s_5_4_3" + ("_HalfFloat" if half else "")
    options = {
        "compression": ZIP | mask,
        "kind": 0,
        "tree": tree,
        "tiles": {1: 7.0},
        "active": (1,),
    }
    (tmp_path / "a.vdb").write_bytes(vdb_bytes(colours, **options))
    found = read_values(tmp_path / "a.vdb", "density").values
    assert found.shape == (16, 8, 8, 3)
    np.testing.assert_array_equal(found[:8], np.moveaxis(colours, (0, 1, 2), (2, 1, 0)))
    assert (found[8:] == 7.0).all()
    with pytest.raises(SceneError, match="has 3 channels, which one is the density"):
        read_volume(tmp_path / "a.vdb")
    green = read_volume(tmp_path / "a.vdb", channels="g").density
    np.testing.assert_array_equal(green, found[..., 1])


def test_a_turned_grid_keeps_its_matrix(tmp_path):
    (tmp_path / "a.vdb").write_bytes(vdb_bytes(COUNTED, matrix=TURNED))
    grid = read_volume(tmp_path / "a.vdb")
    assert grid.bounds == ((-0.5,) * 3, (7.5,) * 3)
    np.testing.assert_array_equal(grid.world_from_volume, TURNED.T)


def test_a_level_set_is_solid_beyond_its_narrow_band(tmp_path):
    x = np.arange(8.0)[:, None, None] + np.zeros((8, 8, 8))
    sdf = np.clip(0.5 * (np.abs(x - 4.0) - 2.5), -0.75, 0.75)
    content = vdb_bytes(sdf, of_class="level set", background=0.75)
    (tmp_path / "a.vdb").write_bytes(content)
    density = read_volume(tmp_path / "a.vdb").density
    np.testing.assert_allclose(density[0, 0], [0, 0, 1, 1, 1, 1, 1, 0], atol=1e-6)


SPARSE = np.where((COUNTED % 3 == 0) & (COUNTED > 0), COUNTED, 0.0)


@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("mask", [0, ACTIVE_MASK])
@pytest.mark.parametrize(
    "compression", [0, ZIP, pytest.param(BLOSC, marks=pytest.mark.needs("blosc"))]
)
def test_every_packing_holds_the_same(tmp_path, compression, mask, half):
    tree = "Tree_float_5_4_3" + ("_HalfFloat" if half else "")
    raw = vdb_bytes(SPARSE, compression=compression | mask, kind=0, tree=tree)
    density = read(tmp_path, raw).density
    # The box is that of the active voxels; whole numbers up to 2048 are exact in half floats.
    np.testing.assert_array_equal(density, SPARSE.transpose(2, 1, 0))


@pytest.mark.parametrize(
    ("kind", "inactive", "expected"),
    [
        (0, (), {False: 0.25, True: 0.25}),
        (1, (), {False: -0.25, True: -0.25}),
        (2, (struct.pack("<f", 7.0),), {False: 7.0, True: 7.0}),
        (3, (), {False: -0.25, True: 0.25}),
        (4, (struct.pack("<f", 7.0),), {False: 7.0, True: 0.25}),
        (5, (struct.pack("<2f", 7.0, 9.0),), {False: 7.0, True: 9.0}),
    ],
)
def test_inactive_values_of_every_kind(tmp_path, kind, inactive, expected):
    chosen = np.arange(512) % 2 == 0
    if kind >= 3:
        inactive = (*inactive, np.packbits(chosen, bitorder="little").tobytes())
    values = np.where(np.arange(512) % 5 == 0, 3.0, 0.0)
    values[[0, -1]] = 3.0  # so that the whole leaf is in the box
    raw = vdb_bytes(values, background=0.25, compression=ACTIVE_MASK, kind=kind, inactive=inactive)
    want = np.where(values > 0, 3.0, np.where(chosen, expected[True], expected[False]))
    if want.min() < 0.0:
        with pytest.raises(SceneError, match="negative"):
            read(tmp_path, raw)
    else:
        np.testing.assert_array_equal(
            read(tmp_path, raw).density, want.reshape(8, 8, 8).transpose(2, 1, 0)
        )


def test_blocks_of_one_value_are_read(tmp_path):
    # Offset 1 of the lower inner node is the block behind the leaf, along z; 16 along y.
    raw = vdb_bytes(COUNTED, tiles={1: 600.0, 16: 5.0}, active=(1,))
    density = read(tmp_path, raw).density
    assert density.shape == (16, 8, 8)
    np.testing.assert_array_equal(density[:8], COUNTED.transpose(2, 1, 0))
    assert (density[8:] == 600.0).all()


def test_the_inside_of_a_level_set_is_solid(tmp_path):
    values = np.full((8, 8, 8), 0.5, np.float32)
    raw = vdb_bytes(
        values, of_class="level set", background=0.5, tiles={1: -0.5, 2: 0.5}, active=(2,)
    )
    density = read(tmp_path, raw).density
    assert density.shape == (24, 8, 8)
    assert not density[:8].any()
    assert (density[8:16] == 1.0).all()


def test_an_instance_shows_the_tree_of_its_parent(tmp_path):
    raw = vdb_bytes(COUNTED, instance=True)
    first, second = (read(tmp_path, raw, grid) for grid in ("density", "copy"))
    np.testing.assert_array_equal(first.density, second.density)
    np.testing.assert_allclose(second.bounds, ((99.5, -0.5, -0.5), (107.5, 7.5, 7.5)))


def test_a_grid_that_is_not_there_is_named(tmp_path):
    with pytest.raises(SceneError, match=r"has no grid 'densty'.*density"):
        read(tmp_path, vdb_bytes(COUNTED, instance=True), "densty")


def test_names_that_are_not_utf_8(tmp_path):
    raw = vdb_bytes(COUNTED).replace(b"density", b"de\xff\xfeity")
    with pytest.raises(SceneError, match=r"a\.vdb: is not a readable \.vdb: .*(?i:utf-8)"):
        read(tmp_path, raw)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"abc" * 50, "is not a .vdb: it does not begin as one"),
        (b"", "is not a readable .vdb: it ends after 0 bytes"),
        (vdb_bytes(COUNTED)[:5000], "is not a readable .vdb: grid 'density' lies outside"),
        (vdb_bytes(COUNTED, version=221), "file version 221, 222 to 224 are read"),
        (vdb_bytes(COUNTED, tree="Tree_int32_5_4_3"), "only trees of float, double and vec3"),
        (vdb_bytes(COUNTED, kind=9), "inactive values are of the unknown kind 9"),
        (vdb_bytes(COUNTED, matrix=np.zeros((4, 4))), "transform is not finite, or flat"),
    ],
)
def test_what_cannot_be_read_says_why(tmp_path, content, problem):
    with pytest.raises(SceneError) as caught:
        read(tmp_path, content)
    assert str(caught.value).startswith(f"{tmp_path / 'a.vdb'}: ")
    assert problem in str(caught.value)


def test_a_grid_without_active_voxels_is_nothing(tmp_path):
    (tmp_path / "a.vdb").write_bytes(vdb_bytes(np.zeros(512), kind=0))
    grid = read_volume(tmp_path / "a.vdb")
    assert not grid.density.any()
    assert grid.warnings == ("a.vdb holds no density at all: there is nothing to see",)


def test_a_sequence_may_begin_and_end_with_empty_frames(tmp_path):
    for number, values in enumerate((np.zeros(512), COUNTED, np.zeros(512))):
        kind = 6 if values.any() else 0
        (tmp_path / f"s{number}.vdb").write_bytes(vdb_bytes(values, kind=kind))
    text = '[[volume]]\nsequence = "s*.vdb"\nsequence_fps = 1\nsigma_t = 1\n'
    (tmp_path / "a.toml").write_text(text)
    scene = load(tmp_path / "a.toml")
    wanted = read_volume(tmp_path / "s1.vdb")
    assert scene.volumes[0].bounds == wanted.bounds
    first, second, third = (scene.at(t).volumes[0].density for t in (0.0, 1.0, 2.0))
    np.testing.assert_array_equal(second, wanted.density)
    # What is loaded is the first moment, and it is said that nothing is seen of it.
    np.testing.assert_array_equal(scene.volumes[0].density, first)
    assert any("no density at all" in text for text in scene.warnings)
    for empty in (first, third):
        assert empty.shape == wanted.density.shape and not empty.any()


def test_a_sequence_may_grow(tmp_path):
    some = np.where(np.indices((8, 8, 8))[1] < 4, COUNTED + 1, 0)
    for number, values in enumerate((some, COUNTED + 1)):
        (tmp_path / f"s{number}.vdb").write_bytes(vdb_bytes(values, kind=0))
    text = '[[volume]]\nsequence = "s*.vdb"\nsequence_fps = 1\nsigma_t = 1\n'
    (tmp_path / "a.toml").write_text(text)
    scene = load(tmp_path / "a.toml")
    alone = [read_volume(tmp_path / f"s{number}.vdb") for number in range(2)]
    assert alone[0].density.shape != alone[1].density.shape
    for number, grid in enumerate(alone):
        found = scene.at(float(number)).volumes[0]
        assert found.bounds == grid.bounds
        np.testing.assert_array_equal(found.density, grid.density)


def root_at(raw: bytes) -> int:
    """Where a root's number of tiles stands: behind the transform, buffers and background."""
    return raw.index(b"ScaleTranslateMap") + len(b"ScaleTranslateMap") + 18 * 8 + 8


@pytest.mark.parametrize("at", [GRIDS_AT, GRIDS_AT + 4, root_at(vdb_bytes(COUNTED))])
def test_counts_that_the_size_cannot_justify(tmp_path, at):
    raw = vdb_bytes(COUNTED)
    with pytest.raises(SceneError, match=r"a\.vdb: is not a readable"):
        read(tmp_path, raw[:at] + struct.pack("<I", 1 << 31) + raw[at + 4 :])


def test_every_cut_is_one_error(tmp_path):
    raw = vdb_bytes(SPARSE, compression=ZIP | ACTIVE_MASK, kind=0)
    for end in range(0, len(raw), 41):
        with pytest.raises(SceneError, match=re.escape("a.vdb: is not a")):
            read(tmp_path, raw[:end])


def test_without_blosc_the_extra_is_named(tmp_path, monkeypatch):
    def refuse(name, *args, **kwargs):
        if name == "blosc":
            raise ImportError
        return real(name, *args, **kwargs)

    real = builtins.__import__
    raw = vdb_bytes(COUNTED)
    at = raw.index(text("class")) - 8
    assert raw[at : at + 4] == bytes(4)
    monkeypatch.setattr(builtins, "__import__", refuse)
    packed_raw = raw[:at] + struct.pack("<I", BLOSC) + raw[at + 4 :]
    # The first packed values are the upper inner node's: any length before them will do.
    first = packed_raw.index(b"\6" + bytes(8)) + 1
    packed_raw = packed_raw[:first] + struct.pack("<q", 32) + packed_raw[first + 8 :]
    with pytest.raises(SceneError, match=r"Run: pip install 'airlight\[vdb\]'\."):
        read(tmp_path, packed_raw)
