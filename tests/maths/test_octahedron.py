"""The octahedral map: round trips, areas, seams, packing."""

import numpy as np
import pytest

from airlight.maths import octahedron as oct


def directions(count: int = 20_000) -> np.ndarray:
    d = np.random.default_rng(9).normal(size=(count, 3))
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    d = np.concatenate([d, axes, [[1, 0, -1], [0, -1, -1], [-1, 1, 0]]])
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def test_round_trip() -> None:
    d = directions()
    square = oct.octahedron_encode(d)
    assert np.abs(square).max() <= 1.0
    np.testing.assert_allclose(oct.octahedron_decode(square), d, atol=1e-14)


def test_upper_half_fills_the_diamond() -> None:
    d = directions()
    inside = np.abs(oct.octahedron_encode(d)).sum(axis=1) < 1.0
    np.testing.assert_array_equal(inside, d[:, 2] > 1e-15)


def test_packing_error() -> None:
    d = directions(200_000)
    packed = oct.octahedron_pack16(d)
    halves = np.stack([packed & 0xFFFF, packed >> 16], axis=-1).astype(np.uint16).view(np.int16)
    back = oct.octahedron_decode(np.maximum(halves / 32767.0, -1.0))
    error = np.linalg.norm(np.cross(d, back), axis=1).max()
    assert 5e-5 < error < 6.5e-5


@pytest.mark.parametrize("count", [2, 8, 20, 64])
def test_cells_tile_the_sphere(count: int) -> None:
    omega = oct.octahedron_cell_solid_angles(count)
    assert omega.shape == (count, count)
    assert omega.sum() == pytest.approx(4.0 * np.pi, rel=1e-12)
    np.testing.assert_allclose(omega, omega[::-1], rtol=1e-10)
    np.testing.assert_allclose(omega, omega.T, rtol=1e-10)


def test_spread_of_cell_sizes_is_that_of_the_notes() -> None:
    omega = oct.octahedron_cell_solid_angles(16)
    assert omega.max() / omega.min() == pytest.approx(3.9, abs=0.25)


def test_cell_sizes_against_counting() -> None:
    rng = np.random.default_rng(10)
    d = rng.normal(size=(400_000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    cell = np.clip(((oct.octahedron_encode(d) + 1.0) * 4.0).astype(int), 0, 7)
    counts = np.bincount(cell[:, 1] * 8 + cell[:, 0], minlength=64).reshape(8, 8)
    expected = oct.octahedron_cell_solid_angles(8) / (4.0 * np.pi) * len(d)
    assert (np.abs(counts - expected) < 5.0 * np.sqrt(expected)).all()


def test_odd_counts_are_refused() -> None:
    with pytest.raises(ValueError, match="even number of cells a side, not 5"):
        oct.octahedron_cell_solid_angles(5)


def test_neighbours_across_seams_are_close() -> None:
    count = 16
    centres = oct.octahedron_cell_centres(count)
    v, u = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    cells = np.stack([u, v], axis=-1)
    for step in ([1, 0], [-1, 0], [0, 1], [0, -1]):
        n = oct.octahedron_neighbour(cells, step, count)
        cosine = np.einsum("vui,vui->vu", centres, centres[n[..., 1], n[..., 0]])
        assert np.arccos(cosine.min()) < 0.303  # the widest step of an inner pair
        back = oct.octahedron_neighbour(n, np.negative(step), count)
        crossed = ((cells + step < 0) | (cells + step >= count)).any(axis=-1)
        # inside, going back returns; across a seam one goes on from the same edge
        assert (back == cells).all(axis=-1)[~crossed].all()


def test_seam_rule() -> None:
    assert oct.octahedron_neighbour([15, 3], [1, 0], 16).tolist() == [15, 12]
    assert oct.octahedron_neighbour([4, 0], [0, -1], 16).tolist() == [11, 0]
    assert oct.octahedron_neighbour([4, 7], [0, -1], 16).tolist() == [4, 6]
