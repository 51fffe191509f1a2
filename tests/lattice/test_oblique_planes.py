"""The planes of oblique surfaces that cells know."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.lattice.placement import Placement
from airlight.scene import Material, Mesh
from airlight.scene.shapes import sphere

N, CELL = 10, 0.5
ROOM = Placement((0.0, 0.0, 0.0), CELL, (N, N, N))
SURFELS = 40_000
ONE_SIDED = Material(two_sided=False)
MIDDLE = np.full(3, 0.5 * N * CELL)


@pytest.fixture
def planes(encoded_blockers):
    """planes(mesh, ...) -> (Z, Y, X, 4), as `Blockers.planes` has them."""
    return lambda *meshes: encoded_blockers(ROOM, SURFELS, *meshes).planes.read().astype(float)


def centres():
    """(Z, Y, X, 3): the middles of cells, cells."""
    z, y, x = np.meshgrid(*[np.arange(N) + 0.5] * 3, indexing="ij")
    return np.stack([x, y, z], axis=-1)


def sheet(square, normal, offset=0.0, half=4.0):
    """A one-sided sheet around the lattice's middle, moved by `offset` metres along its normal."""
    u = np.cross(normal, (0.0, 1.0, 0.0))
    v = np.cross(normal, u / np.linalg.norm(u))
    middle = MIDDLE + offset * normal
    return square(middle, half * v, half * u / np.linalg.norm(u), ONE_SIDED)


def direction(turned_deg, raised_deg=0.0):
    turn, rise = np.radians((turned_deg, raised_deg))
    return np.array([np.cos(turn) * np.cos(rise), np.sin(rise), np.sin(turn) * np.cos(rise)])


@pytest.mark.parametrize(("turned", "raised"), [(12, 0), (30, 0), (44, 0), (-70, 0), (20, 25)])
def test_cells_know_the_plane_that_they_are_near(planes, square, turned, raised):
    normal, offset = direction(turned, raised), 0.13
    found = planes(sheet(square, normal, offset))
    height = (centres() - MIDDLE / CELL) @ normal - offset / CELL
    # Columns of four corners hold the plane within a cell of its middle, whatever its angle. The
    # corners of the lattice's border have half of what the others have.
    inner = np.zeros((N, N, N), bool)
    inner[1:-1, 1:-1, 1:-1] = True
    near = inner & (np.abs(height) < 1.0)
    size = np.linalg.norm(found[..., :3], axis=-1)
    assert near.sum() > 100
    # Surfels are samples: some columns have a few less than the plane's area.
    assert size[near].min() > 0.98
    # A half float is known to 2^-11 of itself, and distances have three products of such numbers.
    side = 1.0 if found[near][0, :3] @ normal > 0.0 else -1.0
    unit = side * found[near][:, :3] / size[near][:, None]
    np.testing.assert_allclose(unit, np.tile(normal, (len(unit), 1)), atol=2e-3)
    np.testing.assert_allclose(side * found[near][:, 3], height[near], atol=2e-3)


def test_a_thin_board_says_so_and_a_body_does_not(planes, square):
    normal = direction(30)
    board = planes(sheet(square, normal, 0.02), sheet(square, -normal, 0.02))
    body = planes(sheet(square, normal, 0.6), sheet(square, -normal, 0.6))
    middle = (slice(3, 7),) * 3
    of_board = np.linalg.norm(board[..., :3], axis=-1)[middle]
    of_body = np.linalg.norm(body[..., :3], axis=-1)[middle]
    height = np.abs((centres() - MIDDLE / CELL) @ normal)[middle]
    np.testing.assert_allclose(of_board[height < 1.0], 3.0, atol=5e-3)
    assert of_body[np.abs(height - 1.2) < 0.5].max() < 1.01


def test_walls_along_the_cells_are_no_planes(planes, square):
    assert not planes(sheet(square, direction(0)), sheet(square, direction(90))).any()


@pytest.mark.parametrize("radius", [2.0, 4.0])
def test_of_curved_things_cells_know_a_tangent_plane_or_none(planes, radius):
    placed = np.diag((*[2.0 * radius * CELL] * 3, 1.0))
    placed[:3, 3] = MIDDLE
    found = planes(Mesh(sphere(), ONE_SIDED, placed))
    # Surfaces are at most .15 of a cell from a plane that counts (their root mean square); where
    # the plane is tangent a cell's middle is at most a cell and a half beside that point.
    height = np.linalg.norm(centres() - MIDDLE / CELL, axis=-1) - radius
    counts = np.linalg.norm(found[..., :3], axis=-1)
    known = (counts > 0.05) & (height > 0.0)
    aside = (1.5**2) / (2.0 * radius)
    assert (np.abs(found[..., 3] - height)[known] < 0.15 + aside).all()
    assert known.any()
