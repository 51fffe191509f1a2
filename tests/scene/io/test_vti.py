"""VTK's image data: every way of storing values, placing, pieces, and damage."""

from __future__ import annotations

import base64
import json
import lzma
import struct
import zlib

import numpy as np
import pytest

from airlight.app.cli import run
from airlight.errors import SceneError
from airlight.scene.io import load
from airlight.scene.io.grid_times import in_time
from airlight.scene.io.volumes import grid_names, read_values, read_volume
from airlight.scene.io.vti import vti_time

VALUES = np.arange(24, dtype="<f4").reshape(2, 3, 4)  # z, y, x
BLOCK = 40  # bytes: 96 of values are two blocks and 16 left


def packed(raw: bytes, compressor: str, header: str = "<I") -> bytes:
    """As VTK writes binary values: their number, or the sizes of packed blocks, before them."""
    if not compressor:
        return struct.pack(header, len(raw)) + raw
    pack = {"vtkZLibDataCompressor": zlib.compress, "vtkLZMADataCompressor": lzma.compress}
    blocks = [raw[k : k + BLOCK] for k in range(0, len(raw), BLOCK)]
    made = [pack[compressor](block) for block in blocks]
    sizes = [len(blocks), BLOCK, len(raw) % BLOCK, *map(len, made)]
    return b"".join(struct.pack(header, n) for n in sizes) + b"".join(made)


def in_base64(raw: bytes, compressor: str, header: str = "<I") -> bytes:
    """VTK encodes the header of packed values on its own."""
    if not compressor:
        return base64.b64encode(raw)
    size = struct.calcsize(header)
    head = size * (3 + struct.unpack_from(header, raw)[0])
    return base64.b64encode(raw[:head]) + base64.b64encode(raw[head:])


def vti(array: str, *, extent="0 3 0 2 0 1", head="", image="", appended=b"", kind="PointData"):
    return (
        f'<?xml version="1.0"?>\n<VTKFile type="ImageData" version="1.0" {head}>\n'
        f'<ImageData WholeExtent="{extent}" {image}><Piece Extent="{extent}">'
        f'<{kind} Scalars="smoke">{array}</{kind}></Piece></ImageData>\n'
    ).encode() + (appended or b"") + b"</VTKFile>\n"  # fmt: skip


def element(form: str, text: str = "", more: str = "", kind: str = "Float32") -> str:
    return f'<DataArray type="{kind}" Name="smoke" format="{form}" {more}>{text}</DataArray>'


@pytest.mark.parametrize("compressor", ["", "vtkZLibDataCompressor", "vtkLZMADataCompressor"])
@pytest.mark.parametrize("form", ["binary", "raw", "base64"])
@pytest.mark.parametrize("header", ["UInt32", "UInt64"])
def test_every_way_of_storing_gives_the_same_values(tmp_path, form, compressor, header):
    layout = {"UInt32": "<I", "UInt64": "<Q"}[header]
    raw = packed(VALUES.tobytes(), compressor, layout)
    head = f'byte_order="LittleEndian" header_type="{header}" compressor="{compressor}"'
    if form == "binary":
        text = vti(element("binary", in_base64(raw, compressor, layout).decode()), head=head)
    else:
        other = b"another array's bytes <&"
        stored = raw if form == "raw" else in_base64(raw, compressor, layout)
        other = other if form == "raw" else base64.b64encode(other)
        appended = f'<AppendedData encoding="{form}">\n _'.encode() + other + stored
        array = element("appended", more=f'offset="{len(other)}"')
        text = vti(array, head=head, appended=appended + b"\n</AppendedData>\n")
    (tmp_path / "a.vti").write_bytes(text)
    np.testing.assert_array_equal(read_volume(tmp_path / "a.vti").density, VALUES)


def test_ascii_and_big_endian(tmp_path):
    (tmp_path / "a.vti").write_bytes(vti(element("ascii", " ".join(map(str, range(24))))))
    np.testing.assert_array_equal(read_volume(tmp_path / "a.vti").density, VALUES)
    raw = packed(VALUES.astype(">i2").tobytes(), "", ">I")
    array = element("binary", in_base64(raw, "").decode(), kind="Int16")
    (tmp_path / "b.vti").write_bytes(vti(array, head='byte_order="BigEndian"'))
    np.testing.assert_array_equal(read_volume(tmp_path / "b.vti").density, VALUES)


def test_points_are_the_centres_of_voxels_and_cells_fill_theirs(tmp_path):
    array = element("ascii", " ".join(map(str, range(24))))
    place = 'Origin="10 20 30" Spacing="1 2 4"'
    (tmp_path / "a.vti").write_bytes(vti(array, image=place))
    assert read_volume(tmp_path / "a.vti").bounds == ((9.5, 19, 28), (13.5, 25, 36))
    cells = vti(array, image=place, extent="2 6 0 3 0 2", kind="CellData")
    (tmp_path / "a.vti").write_bytes(cells)
    assert read_volume(tmp_path / "a.vti").bounds == ((12, 20, 30), (16, 26, 38))


def test_a_turned_image_is_turned(tmp_path):
    array = element("ascii", " ".join(map(str, range(24))))
    turned = 'Origin="5 0 0" Direction="0 -1 0 1 0 0 0 0 1"'
    (tmp_path / "a.vti").write_bytes(vti(array, image=turned))
    grid = read_volume(tmp_path / "a.vti")
    # The first voxel's centre is the origin, the next along i lies along +y.
    low = np.array(grid.bounds[0]) + 0.5
    np.testing.assert_allclose((grid.world_from_volume @ [*low, 1])[:3], [5, 0, 0])
    np.testing.assert_allclose((grid.world_from_volume @ [low[0] + 1, *low[1:], 1])[:3], [5, 1, 0])
    assert read_values(tmp_path / "a.vti", "smoke").world_from_volume[0, 3] == 5


def test_pieces_are_put_together(tmp_path):
    pieces = "".join(
        f'<Piece Extent="{a} {b} 0 2 0 1"><PointData>'
        + element("ascii", " ".join(map(str, VALUES[..., a : b + 1].ravel())))
        + "</PointData></Piece>"
        for a, b in ((0, 1), (1, 3))
    )
    text = f'<VTKFile type="ImageData"><ImageData WholeExtent="0 3 0 2 0 1">{pieces}'
    (tmp_path / "a.vti").write_text(text + "</ImageData></VTKFile>")
    np.testing.assert_array_equal(read_volume(tmp_path / "a.vti").density, VALUES)
    assert grid_names(tmp_path / "a.vti") == ["smoke"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b'<VTKFile type="UnstructuredGrid"/>', "VTK's type UnstructuredGrid, only ImageData"),
        (b"<!DOCTYPE x><VTKFile/>", "a document type"),
        (vti(element("ascii", "1 2 3")), "it has 3 values, its extent asks for 24"),
        (vti(element("ascii"), extent="0 9 0 9"), "its Extent has 4 numbers, not 6"),
        (vti(element("ascii"), extent="0 2047 0 2047 0 2047"), "8,589,934,592 values, at most"),
        (vti(element("binary", "AAAA")), "is not a readable .vti"),
        (vti(element("binary", "AAAAAAAA"), head='compressor="vtkLZ4DataCompressor"'),
         "packed by vtkLZ4DataCompressor, only zlib and LZMA"),
        (vti(element("binary", in_base64(packed(b"\0" * 96, ""), "").decode()),
             head='compressor="vtkZLibDataCompressor"'), "its blocks hold"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_one_message(tmp_path, text, message):
    (tmp_path / "a.vti").write_bytes(text)
    with pytest.raises(SceneError, match=r"a\.vti: ") as caught:
        read_volume(tmp_path / "a.vti")
    assert message in str(caught.value)


def test_several_arrays_want_a_name(tmp_path):
    two = element("ascii", "1 " * 24).replace("smoke", "b") + element("ascii", "2 " * 24)
    text = vti(two).replace(b'Scalars="smoke"', b"").replace(b'Name="smoke"', b'Name="a"')
    (tmp_path / "a.vti").write_bytes(text)
    with pytest.raises(SceneError, match=r"no grid 'density'\. Known: a, b"):
        read_volume(tmp_path / "a.vti")
    assert read_volume(tmp_path / "a.vti", "b").density.max() == 1


def test_a_sequence_may_grow_and_move(tmp_path):
    for k, (extent, count) in enumerate((("0 3 0 2 0 1", 24), ("2 3 0 2 0 3", 24))):
        numbers = " ".join(str(k + n) for n in range(count))
        image = 'Origin="1 0 0" Spacing="0.5 0.5 0.5"'
        (tmp_path / f"s{k}.vti").write_bytes(
            vti(element("ascii", numbers), extent=extent, image=image)
        )
    text = '[[volume]]\nsequence = "s*.vti"\nsequence_fps = 1\nsigma_t = 1\ngrid = "smoke"\n'
    (tmp_path / "a.toml").write_text(text)
    scene = load(tmp_path / "a.toml")
    for k in range(2):
        found, grid = scene.at(float(k)).volumes[0], read_volume(tmp_path / f"s{k}.vti", "smoke")
        assert found.bounds == grid.bounds
        np.testing.assert_array_equal(found.density, grid.density)
    # Half of each where they meet, on a box around both.
    assert scene.at(0.5).volumes[0].density.shape == (4, 3, 4)


def test_points_that_follow_each_other_downwards_are_turned_round(tmp_path):
    text = " ".join(f"{v:g}" for v in VALUES.ravel())
    path = tmp_path / "a.vti"
    path.write_bytes(vti(element("ascii", text), image='Origin="0 0 5" Spacing="1 1 -2"'))
    grid = read_volume(path)
    np.testing.assert_array_equal(grid.density, VALUES[::-1])
    np.testing.assert_allclose(grid.bounds, ((-0.5, -0.5, 2), (3.5, 2.5, 6)))


def test_a_spacing_that_means_nothing_and_a_flat_image_are_told(tmp_path):
    text = " ".join(f"{v:g}" for v in VALUES.ravel())
    path = tmp_path / "a.vti"
    for spacing, said in (("1 1 0", "its Spacing '1 1 0' has a 0"), ("1 1 1e12", "larger unit")):
        path.write_bytes(vti(element("ascii", text), image=f'Spacing="{spacing}"'))
        with pytest.raises(SceneError, match=said):
            read_volume(path)
    flat = " ".join(f"{v:g}" for v in VALUES[0].ravel())
    path.write_bytes(vti(element("ascii", flat), extent="0 3 0 2 0 0"))
    assert "a.vti is flat: it has one layer along z" in read_volume(path).warnings


def test_values_that_are_no_numbers_are_none(tmp_path):
    text = " ".join("nan" if v < 2 else f"{v:g}" for v in VALUES.ravel())
    (tmp_path / "a.vti").write_bytes(vti(element("ascii", text)))
    grid = read_volume(tmp_path / "a.vti")
    assert grid.density.min() == 0.0 and grid.density.max() == 23.0
    told = [warning for warning in grid.warnings if "missing" in warning]
    assert told == ["a.vti: 'smoke' has 2 missing values, taken as 0"]


def timed(path, time: float | None, *, form: str = "ascii", more: float = 0.0) -> None:
    """A grid whose values are `more` than usual, of a time."""
    head, appended = 'header_type="UInt32"', b""
    said = "" if time is None else f"{time}"
    stored = struct.pack("<d", 0.0 if time is None else time)
    offset = ""
    if form == "binary":
        said = in_base64(packed(stored, ""), "").decode()
    elif form == "appended":
        appended = b'<AppendedData encoding="raw">_' + packed(stored, "") + b"</AppendedData>"
        said, offset = "", 'offset="0"'
    elif form == "base64":
        text = in_base64(packed(stored, ""), "") + in_base64(packed(VALUES.tobytes(), ""), "")
        appended = b'<AppendedData encoding="base64">_' + text + b"</AppendedData>"
        said, form, offset = "", "appended", 'offset="0"'
    field = (
        f'<DataArray type="Float64" Name="TimeValue" format="{form}" {offset}>{said}</DataArray>'
    )
    numbers = " ".join(f"{v + more:g}" for v in VALUES.ravel())
    raw = vti(element("ascii", numbers), head=head, appended=appended)
    held = b"" if time is None else f"<FieldData>{field}</FieldData>".encode()
    path.write_bytes(raw.replace(b"<Piece", held + b"<Piece", 1))


@pytest.mark.parametrize("form", ["ascii", "binary", "appended", "base64"])
def test_the_time_of_a_file_is_read_however_it_is_stored(tmp_path, form):
    timed(tmp_path / "a.vti", 0.25, form=form)
    assert vti_time(tmp_path / "a.vti") == 0.25
    timed(tmp_path / "a.vti", None)
    assert vti_time(tmp_path / "a.vti") is None
    assert read_volume(tmp_path / "a.vti").density.max() == 23.0


def test_the_time_of_a_large_file_is_read_from_its_head(tmp_path):
    timed(tmp_path / "a.vti", 0.25)
    raw = (tmp_path / "a.vti").read_bytes()
    begin = raw.index(b"<PointData")
    (tmp_path / "a.vti").write_bytes(raw[:begin] + b" " * (1 << 21) + raw[begin:])
    assert vti_time(tmp_path / "a.vti") == 0.25
    # Nothing behind is looked at: a file that is cut off says its time.
    (tmp_path / "a.vti").write_bytes(raw[:begin])
    assert vti_time(tmp_path / "a.vti") == 0.25


def test_files_that_say_when_they_are_follow_each_other_by_that(tmp_path):
    for k, time in enumerate((4.0, 2.0, 0.0)):
        timed(tmp_path / f"s{k}.vti", time, more=k)
    files, times, told = in_time(tuple(tmp_path / f"s{k}.vti" for k in range(3)))
    assert [f.name for f in files] == ["s2.vti", "s1.vti", "s0.vti"] and times == (0.0, 2.0, 4.0)
    assert told == (
        "s0.vti and those after it follow each other by their TimeValue, not by the numbers in "
        "their names",
    )
    # A bare folder and a scene file show them so; twelve a second, as simulations are.
    scene = load(tmp_path)
    assert scene.animation.fps == 12.0 and set(told) < set(scene.warnings)
    (tmp_path / "a.toml").write_text(
        '[[volume]]\nsequence = "s*.vti"\nsequence_fps = 1\nsigma_t = 1\n'
    )
    for moving, step_s in ((scene, 1 / 12), (load(tmp_path / "a.toml"), 1.0)):
        peaks = [moving.at(k * step_s).volumes[0].density.max() for k in range(3)]
        assert peaks == [25.0, 24.0, 23.0]


def test_uneven_times_are_told_and_files_without_one_go_by_their_names(tmp_path):
    paths = tuple(tmp_path / f"s{k}.vti" for k in range(3))
    for path, time in zip(paths, (0.0, 1.0, 5.0), strict=True):
        timed(path, time)
    uneven = "s0.vti and those after it: TimeValue is not evenly spaced: a sequence shows its times"
    assert in_time(paths) == (paths, (0.0, 1.0, 5.0), (f"{uneven} evenly",))
    timed(paths[1], None)
    assert in_time(paths) == (paths, (), ())
    assert load(tmp_path).animation.fps == 24.0


def test_info_lists_the_times_of_files(tmp_path, capsys):
    for k in range(3):
        timed(tmp_path / f"s{k}.vti", 0.5 * k)
    assert run(["info", str(tmp_path), "--json"]) == 0
    axes = json.loads(capsys.readouterr().out)["time_axes"]
    assert axes == [{"name": "TimeValue", "values": [0.0, 0.5, 1.0]}]
