"""Light as OpenVDB files: read back by our own reader, and by the library's tool where it is."""

from __future__ import annotations

import subprocess

import numpy as np
import pytest

from airlight.exports.light_field import LatticeLight, LightField, VolumeLight
from airlight.exports.vdb import VdbGrid, light_grids, vdb_bytes
from airlight.scene.io.openvdb import openvdb_names, read_openvdb

RNG = np.random.default_rng(7)


def placed() -> np.ndarray:
    """A turned and moved grid of voxels of .5 m."""
    matrix = np.eye(4)
    matrix[:3] = [[0, -0.5, 0, 1], [0.5, 0, 0, 2], [0, 0, 0.5, 3]]
    return matrix


@pytest.mark.parametrize("shape", [(1, 1, 1), (8, 8, 8), (9, 140, 34), (3, 2, 129)])
def test_values_and_place_come_back(tmp_path, shape):
    values = RNG.random(shape).astype(np.float32)
    (tmp_path / "a.vdb").write_bytes(vdb_bytes([VdbGrid("a", values, placed(), "")], {}))
    grid = read_openvdb(tmp_path / "a.vdb", "a")
    np.testing.assert_array_equal(grid.values.transpose(2, 1, 0), values)
    assert grid.first == (0, 0, 0) and not grid.is_level_set
    np.testing.assert_allclose(grid.world_from_index, placed())


def test_dark_blocks_are_left_out_and_a_dark_grid_is_not_empty(tmp_path):
    values = np.zeros((16, 16, 16), np.float32)
    values[9, 10, 11] = 2.0
    made = [VdbGrid("one", values, placed(), ""), VdbGrid("none", values * 0, placed(), "")]
    (tmp_path / "a.vdb").write_bytes(vdb_bytes(made, {}))
    grid = read_openvdb(tmp_path / "a.vdb", "one")
    assert grid.first == (8, 8, 8) and grid.values[3, 2, 1] == 2.0 and grid.values.sum() == 2.0
    assert read_openvdb(tmp_path / "a.vdb", "none").values.max() == 0.0


def field() -> LightField:
    turned = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    cells = LatticeLight(
        origin=(1.0, 2.0, 3.0),
        cell=0.25,
        fade=np.zeros((4, 3)),
        openness=np.ones((4, 3, 2, 6), np.float32),
        surfaces=RNG.random((4, 3, 2, 3, 4)).astype(np.float32),
        walls=np.zeros((4, 3, 2, 3), np.float32),
        axes=turned,
    )
    volume = VolumeLight(np.ones((5, 4, 2, 3), np.float32), np.diag([2.0, 4, 10, 1]), (0, 0, 0))
    return LightField("auto", "a scene", (cells,), (volume,))


def test_cells_lie_where_the_lattice_has_them():
    made = field()
    light, volume = light_grids(made)
    lattice = made.lattices[0]
    world = light.world_from_index @ [1, 2, 3, 1]
    own = lattice.axes @ world[:3]
    np.testing.assert_allclose((own - lattice.origin) / lattice.cell, [1.5, 2.5, 3.5])
    np.testing.assert_allclose(light.values, lattice.surfaces[..., 0])
    # The unit cube of 2 x 4 x 5 cells is 2 x 4 x 10 m: cells of 1 x 1 x 2 m.
    np.testing.assert_allclose(volume.world_from_index @ [1, 0, 2, 1], [1.5, 0.5, 5, 1])


def test_a_field_is_saved_with_names_and_the_same_bytes_each_time(tmp_path):
    made = field()
    made.save(tmp_path / "a.vdb")
    made.save(tmp_path / "b.vdb")
    assert openvdb_names(tmp_path / "a.vdb") == ["lattice0_mean_radiance", "volume0"]
    assert (tmp_path / "a.vdb").read_bytes() == (tmp_path / "b.vdb").read_bytes()


@pytest.mark.needs(("libopenvdb-tools", "vdb_print"))
def test_the_librarys_own_tool_reads_it(tmp_path):
    values = RNG.random((9, 140, 34, 3)).astype(np.float32) + 1
    (tmp_path / "a.vdb").write_bytes(vdb_bytes([VdbGrid("light", values, placed(), "x")], {}))
    said = subprocess.run(
        ["vdb_print", "-l", str(tmp_path / "a.vdb")], capture_output=True, text=True, check=True
    ).stdout
    assert "Tree_vec3s_5_4_3" in said
    assert f"Number of active voxels:       {values[..., 0].size:,}" in said
    assert "[0, 0, 0] -> [33, 139, 8]" in said
