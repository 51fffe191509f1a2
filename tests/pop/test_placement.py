"""Where a medium's cells are: turned, mirrored, sheared and long volumes."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.transforms import F64
from airlight.pop.medium.placement import medium_width, placed, shape_density
from airlight.scene.volume import Volume

BOUNDS = ((-1.0, 0.0, 2.0), (1.0, 3.0, 2.5))
TURNED = np.array([[0.6, 0.8, 0.0, 1.0], [-0.8, 0.6, 0.0, 2.0], [0, 0, 2.0, 3.0], [0, 0, 0, 1.0]])
MIRRORED = np.diag([-1.0, 1.0, 1.0, 1.0])
SHEARED = np.array([[1.0, 0.5, 0, 0], [0, 1.0, 0, 0], [0, 0.2, 1.0, 0], [0, 0, 0, 1.0]])


def volume(matrix: F64) -> Volume:
    return Volume((1.0,) * 3, shape="box", bounds=BOUNDS, world_from_volume=matrix)


@pytest.mark.parametrize("matrix", [np.eye(4), TURNED, MIRRORED, SHEARED])
def test_the_box_holds_the_volume_and_knows_its_voxels(matrix):
    at = placed(volume(matrix), 10)
    rotation = at.world_from_medium[:3, :3]
    np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-9)
    unit = np.random.default_rng(1).random((40, 3))
    low, high = np.asarray(BOUNDS)
    world = (low + unit * (high - low)) @ matrix[:3, :3].T + matrix[:3, 3]
    local = at.point(world)
    assert np.all((local > -1e-9) & (local < at.extent + 1e-9))
    back = local @ at.unit_from_medium[:3, :3].T + at.unit_from_medium[:3, 3]
    np.testing.assert_allclose(back, unit, atol=1e-9)
    uvw = world @ at.uvw_from_world[:3, :3].T + at.uvw_from_world[:3, 3]
    np.testing.assert_allclose(uvw, local / at.extent, atol=1e-9)


def test_a_box_without_shear_is_filled_and_cells_are_nearly_cubes():
    at = placed(volume(TURNED), 10)
    np.testing.assert_allclose(sorted(at.extent), [1.0, 2.0, 3.0])
    assert at.cells == pytest.approx(1000, rel=0.2)
    assert at.cell.max() / at.cell.min() < 1.2


def test_flat_volumes_stay_within_bounds():
    flat = Volume((1.0,) * 3, shape="box", bounds=((0, 0, 0), (10.0, 10.0, 0.01)))
    at = placed(flat, 8)
    assert min(at.count) == 2
    assert max(at.count) == 32


def test_a_sphere_limits_diffusion_to_a_third_of_its_radius():
    ball = Volume((1.0,) * 3, shape="sphere", bounds=((-2.0,) * 3, (2.0,) * 3))
    width = medium_width(ball, placed(ball, 10))
    assert width.diffusivity == pytest.approx(2.0 / 3.0, rel=0.02)
    assert width.density == pytest.approx(1.0, abs=0.03)
    assert shape_density(ball, 32).mean() == pytest.approx(np.pi / 6.0, rel=0.01)
