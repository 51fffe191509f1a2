"""Density grids: axis order, bounds, channels, and files that lie about their size."""

from __future__ import annotations

import io
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.volumes import LARGEST_VALUE_COUNT, read_values, read_volume

SHIPPED = Path(__file__).parents[3] / "../shared/data/volume"


def vol_bytes(values: np.ndarray, box=(0, 0, 0, 1, 2, 3), *, version=3, encoding=1) -> bytes:
    """A Mitsuba grid volume of (z, y, x, channel) values."""
    nz, ny, nx, channel_count = values.shape
    header = struct.pack("<3sBiiiii6f", b"VOL", version, encoding, nx, ny, nz, channel_count, *box)
    return header + values.astype("<f4").tobytes()


def counted(*shape: int) -> np.ndarray:
    return np.arange(np.prod(shape), dtype=np.float32).reshape(shape)


def test_npy_is_z_y_x(tmp_path):
    np.save(tmp_path / "a.npy", counted(2, 3, 4).astype(np.float64))
    grid = read_volume(tmp_path / "a.npy")
    np.testing.assert_array_equal(grid.density, counted(2, 3, 4))
    assert grid.density.dtype == np.float32
    # Cubic voxels, 2 m along x, the longest side.
    assert grid.bounds == ((-1.0, -0.75, -0.5), (1.0, 0.75, 0.5))
    assert grid.warnings == (
        "a.npy does not say where it is: it fills 2 x 1.5 x 1 m around the origin",
    )


def test_fortran_order_is_put_right(tmp_path):
    np.save(tmp_path / "a.npy", np.asfortranarray(counted(2, 3, 4)))
    np.testing.assert_array_equal(read_volume(tmp_path / "a.npy").density, counted(2, 3, 4))


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_npz_holds_named_grids_and_bounds(tmp_path, save):
    save(tmp_path / "a.npz", heat=counted(2, 3, 4), bounds=[[0, 0, 0], [1, 2, 3]])
    grid = read_volume(tmp_path / "a.npz", grid="heat")
    np.testing.assert_array_equal(grid.density, counted(2, 3, 4))
    assert grid.bounds == ((0, 0, 0), (1, 2, 3))
    with pytest.raises(SceneError, match=r"a\.npz: has no array 'density'\. Known: bounds, heat\."):
        read_volume(tmp_path / "a.npz")


def test_vol_is_x_fastest_with_its_own_bounds(tmp_path):
    (tmp_path / "a.vol").write_bytes(vol_bytes(counted(2, 3, 4, 1)))
    grid = read_volume(tmp_path / "a.vol")
    np.testing.assert_array_equal(grid.density, counted(2, 3, 4))
    assert grid.bounds == ((0, 0, 0), (1, 2, 3))
    assert grid.warnings == ()


def test_the_cloud_of_the_mitsuba_tutorials():
    if not SHIPPED.exists():
        pytest.skip("data of others is not beside the repository")
    grid = read_volume(SHIPPED / "volume.vol")
    assert grid.density.shape == (53, 45, 44)
    assert float(grid.density.min()) == 0.0
    assert float(grid.density.max()) > 0.0


def test_a_grid_of_nothing_is_read_and_said_to_be_nothing(tmp_path):
    (tmp_path / "a.vol").write_bytes(vol_bytes(np.zeros((2, 2, 2, 1))))
    grid = read_volume(tmp_path / "a.vol")
    assert grid.density.max() == 0.0
    assert grid.warnings == ("a.vol holds no density at all: there is nothing to see",)


def test_a_channel_is_chosen_by_name(tmp_path):
    (tmp_path / "a.vol").write_bytes(vol_bytes(counted(2, 3, 4, 3)))
    np.testing.assert_array_equal(
        read_volume(tmp_path / "a.vol", channels="g").density, counted(2, 3, 4, 3)[..., 1]
    )


@pytest.mark.parametrize(
    ("channels", "expected"),
    [
        (
            "density",
            'has 3 channels, which one is the density is not clear. Say channels = "r", '
            '"g", "b" or "a", or --channels.',
        ),
        ("a", "has 3 channels, there is no channel 'a'"),
        ("dens", "channels = 'dens' is unknown. Did you mean 'density'?"),
    ],
)
def test_channel_mistakes(tmp_path, channels, expected):
    (tmp_path / "a.vol").write_bytes(vol_bytes(counted(2, 3, 4, 3)))
    with pytest.raises(SceneError) as caught:
        read_volume(tmp_path / "a.vol", channels=channels)
    assert str(caught.value) == f"{tmp_path / 'a.vol'}: {expected}"


def huge_npy_header() -> bytes:
    """An .npy header that promises 4 PiB, and nothing after it."""
    out = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        out, {"descr": "<f4", "fortran_order": False, "shape": (1 << 20, 1 << 15, 1 << 15)}
    )
    return out.getvalue()


def npz_of(member: bytes) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        archive.writestr("density.npy", member)
    return out.getvalue()


def npy_bytes(values: np.ndarray) -> bytes:
    out = io.BytesIO()
    np.save(out, values)
    return out.getvalue()


ONE = vol_bytes(np.ones((1, 1, 1, 1)))
TOO_MANY = f"at most {LARGEST_VALUE_COUNT:,} can be used. Downsample it."

DAMAGED = [
    ("a.npy", b"", "is not a NumPy array, or its header is damaged"),
    ("a.npy", b"\x93NUMPY\x01\x00\xff", "is not a NumPy array, or its header is damaged"),
    ("a.npy", huge_npy_header(), f"has 1,125,899,906,842,624 values, {TOO_MANY}"),
    ("a.npy", npy_bytes(counted(2, 3, 4))[:-1], "is cut short: 95 of 96 bytes of values"),
    (
        "a.npy",
        npy_bytes(np.ones((2, 2, 2), complex)),
        "holds complex128 values, it must hold numbers",
    ),
    ("a.npy", npy_bytes(np.array([[[None]]])), "holds Python objects, it must hold numbers"),
    ("a.npy", npy_bytes(counted(4)), "has shape (4,), it must be (z, y, x) or (z, y, x, channel)"),
    ("a.npy", npy_bytes(np.ones((0, 2, 2))), "is empty: its shape is (0, 2, 2)"),
    (
        "a.npy",
        npy_bytes(np.array([[[np.nan, -np.inf, np.inf]]])),
        "2 of its 3 values are infinite. Repair it. NaN, no value, is read as 0.",
    ),
    (
        "a.npy",
        npy_bytes(np.array([[[1.0, -np.inf]]])),
        "1 of its 2 values is infinite. Repair it. NaN, no value, is read as 0.",
    ),
    (
        "a.npy",
        npy_bytes(np.array([[[1.0, -0.5]]])),
        "has negative densities, down to -0.5. A density is at least 0: numpy.clip.",
    ),
    (
        "a.vol",
        vol_bytes(np.full((1, 1, 1, 1), -2.0)),
        "has negative densities, down to -2. A density is at least 0: numpy.clip.",
    ),
    (
        "a.npz",
        b"PK nothing",
        "is not a readable .npz: File is not a zip file. Write it with numpy.savez.",
    ),
    ("a.npz", npz_of(huge_npy_header()), f"has 1,125,899,906,842,624 values, {TOO_MANY}"),
    ("a.vol", b"VOL", "is not a Mitsuba volume: it does not start with 'VOL' and a header"),
    ("a.vol", b"X" * 60, "is not a Mitsuba volume: it does not start with 'VOL' and a header"),
    ("a.vol", ONE[:-1], "has 51 bytes, its header of 1 x 1 x 1 voxels and 1 channels needs 52"),
    (
        "a.vol",
        vol_bytes(np.ones((1, 1, 1, 1)), version=2),
        "has version 2 and encoding 1, only version 3 with encoding 1 (float32) is read",
    ),
    (
        "a.vol",
        struct.pack("<3sBiiiii6f", b"VOL", 3, 1, -4, 2, 2, 1, *[0.0] * 6),
        "has an impossible size -4 x 2 x 2 x 1",
    ),
    (
        "a.vol",
        struct.pack("<3sBiiiii6f", b"VOL", 3, 1, 1 << 30, 1 << 30, 1 << 30, 1, *[0.0] * 6),
        f"has 1,237,940,039,285,380,274,899,124,224 values, {TOO_MANY}",
    ),
    (
        "a.vol",
        vol_bytes(np.ones((1, 1, 1, 1)), (0, 0, 0, 0, 1, 1)),
        "the bounding box in its header is empty: [0.0, 0.0, 0.0] to [0.0, 1.0, 1.0]",
    ),
    ("a.nvdb", b"", "is not a NanoVDB file"),
    (
        "a.txt",
        b"",
        "is not a density grid. Known endings: .npy, .npz, .vol, .vti, .nc, .nc4, .zarr, .nvdb, "
        ".vdb.",
    ),
]


@pytest.mark.parametrize(("name", "content", "expected"), DAMAGED, ids=[d[2] for d in DAMAGED])
def test_damaged_files_get_one_exact_message(tmp_path, name, content, expected):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(SceneError) as caught:
        read_volume(path)
    assert str(caught.value) == f"{path}: {expected}"


def test_an_npz_whose_content_is_damaged(tmp_path):
    good = bytearray(npz_of(npy_bytes(counted(2, 3, 4))))
    good[160] ^= 0xFF  # inside the values: the checksum no longer holds
    (tmp_path / "a.npz").write_bytes(good)
    with pytest.raises(SceneError, match=r"a\.npz: is not a readable \.npz: Bad CRC-32"):
        read_volume(tmp_path / "a.npz")


def test_a_compressed_npz_whose_content_is_damaged(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", density=counted(8, 9, 10))
    good = bytearray((tmp_path / "a.npz").read_bytes())
    good[60:160] = bytes(100)
    (tmp_path / "a.npz").write_bytes(good)
    with pytest.raises(SceneError, match=r"a\.npz: is not a readable \.npz: "):
        read_volume(tmp_path / "a.npz")


def test_a_missing_file(tmp_path):
    with pytest.raises(SceneError, match="file not found"):
        read_volume(tmp_path / "gone.npy")


def test_sides_that_devices_do_not_take_are_averaged(tmp_path):
    long = np.ones((2, 3, 5000), np.float32)
    long[..., 0], long[..., -1] = 4.0, 0.0
    np.save(tmp_path / "a.npy", long)
    grid = read_volume(tmp_path / "a.npy")
    assert grid.density.shape == (2, 3, 1667)
    np.testing.assert_allclose(grid.density[0, 0, [0, 1, -1]], (2.0, 1.0, 0.5))
    assert grid.warnings[-1] == (
        "a.npy has 5000 x 3 x 2 voxels, averaged to 1667 x 3 x 2: at most 2048 on a side"
    )


def test_what_is_no_number_is_no_density_in_any_file(tmp_path):
    values = np.ones((2, 3, 4), np.float32)
    values[0, 0, :2] = np.nan
    np.save(tmp_path / "a.npy", values)
    np.savez(tmp_path / "a.npz", smoke=values)
    for name, grid in (("a.npy", "density"), ("a.npz", "smoke")):
        found = read_volume(tmp_path / name, grid)
        assert found.density.min() == 0.0 and found.density.sum() == 22.0
        told = [text for text in found.warnings if "missing" in text]
        assert told == [f"{name}: '{grid}' has 2 missing values, taken as 0"]
    assert read_values(tmp_path / "a.npz", "smoke").values.sum() == 22.0
