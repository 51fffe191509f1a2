"""A scattering lattice cut out of a larger one holds the larger one's light."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Texture, buffer_of
from airlight.lattice.placement import Placement
from airlight.scatter.inject_outer import InjectOuter
from airlight.scatter.schedule import schedule
from airlight.scatter.state_sum import LatticeKind, StateSum

OUTER = Placement((0.0, 0.0, 0.0), 0.5, (18, 14, 16))
SPAN = max(OUTER.count)
ITERATIONS = 120
THIN, FOG, DENSE = 0.02, 0.4, 2.0  # m^-1
ALBEDO = 0.95


class Nest:
    """Solved states (3, Z, Y, X, 4), W, and tracks, W m, of OUTER and of an `inner` lattice."""

    def __init__(self, gpu, commands, owned, inner, sources, sigma, *, is_varied=False) -> None:
        rows = OUTER.count[1] + inner.count[1]
        inner = Placement(inner.origin, inner.cell, inner.count, first_row=OUTER.count[1])
        size = (18, rows, 16)
        bound = {}
        for name, format, value in (
            ("visibility_a", "rgba8unorm", 255),
            ("visibility_b", "rgba8unorm", 255),
            ("walls", "rgba8snorm", 0),
        ):
            bound[f"lattice_{name}"] = texture = owned(
                Texture(gpu, name, size, format, dimension="3d")
            )
            texture.write(np.full((*size[::-1], 4), value, np.int8 if value == 0 else np.uint8))
        sigma_t, around, total = (sigma,) * 3, None, None
        self.sums, self.tracks = [], []
        for place in (OUTER, inner):
            span = round(SPAN * OUTER.cell / place.cell)
            kind = LatticeKind(has_walls=False, is_varied=is_varied, span=span)
            states = StateSum(gpu, place.count, place.cell, schedule("none", ITERATIONS), kind)
            if is_varied:
                pairs = np.array([ALBEDO * sigma, sigma], np.float32)
                medium = np.broadcast_to(pairs, (3 * place.cells, 2))
                states.set_varied(owned(buffer_of(gpu, "medium", np.ascontiguousarray(medium))))
            else:
                states.set_homogeneous((ALBEDO * sigma,) * 3, sigma_t)
            own = owned(buffer_of(gpu, "own", emitted(place, *sources)))
            if around is not None:
                InjectOuter(gpu, is_varied=is_varied).encode(
                    commands,
                    (inner, OUTER),
                    (states.medium, around.medium),
                    bound,
                    outer_sum=total,
                    cells=own,
                    sigma_t=sigma_t,
                )
            around, (total, track) = states, states.encode(commands, own)
            commands.submit()
            shape = (3, *place.count[::-1], 4)
            self.sums.append(total.read().reshape(shape).astype(np.float64))
            self.tracks.append(track.read().reshape(shape).astype(np.float64))


@pytest.fixture
def nest(gpu, commands, owned):
    def solve(*given, **named):
        return Nest(gpu, commands, owned, *given, **named)

    return solve


def emitted(place, points, powers):
    """(3 * cells, 4): isotropic power, W, in the cells of a lattice that hold the points."""
    cells = np.zeros((3, *place.count[::-1], 4), np.float32)
    at = np.floor((points - np.array(place.origin)) / place.cell).astype(int)
    inside = ((at >= 0) & (at < place.count)).all(axis=1)
    for (x, y, z), power in zip(at[inside], powers[inside], strict=True):
        cells[:, z, y, x, 0] += power
    return cells.reshape(-1, 4)


def sources(seed, count=20):
    rng = np.random.default_rng(seed)
    return rng.uniform(0.3, 0.97, (count, 3)) * (9.0, 7.0, 8.0), np.ones(count)


def error(found, truth):
    return float(np.linalg.norm(found - truth) / np.linalg.norm(truth))


@pytest.mark.parametrize(
    ("sigma", "is_varied"),
    [
        pytest.param(THIN, False, marks=pytest.mark.slow),
        (FOG, False),
        pytest.param(FOG, True, marks=pytest.mark.slow),
        pytest.param(DENSE, True, marks=pytest.mark.slow),
    ],
)
def test_with_cells_of_the_same_size_it_is_the_same_light(nest, sigma, is_varied):
    inner = Placement((3.0, 2.0, 1.5), 0.5, (8, 8, 10))
    solved = nest(inner, sources(3), sigma, is_varied=is_varied)
    outer, found = solved.sums
    # All that is let in is what the larger lattice's own step exchanges there; what cells keep of
    # the light that they send outside is theirs in both.
    truth = outer[:, 3:13, 4:12, 6:14]
    # What is under way after so many iterations is left: 1.4e-4 in dense fog.
    assert error(found, truth) < 3e-4


# Measured .93 in dense fog, where a cell of the larger lattice is an optical depth.
@pytest.mark.parametrize(("sigma", "off"), [(THIN, 0.05), (FOG, 0.05), (DENSE, 0.1)])
def test_light_from_outside_brings_its_fluence_to_finer_cells(nest, sigma, off):
    points, powers = sources(4, 60)
    inner = Placement((3.0, 2.0, 2.0), 0.25, (16, 16, 16))
    far = (np.abs(points - (5.0, 4.0, 4.0)) > 2.5).any(axis=1)
    solved = nest(inner, (points[far], powers[far]), sigma)
    outer, found = (track[..., 0] for track in solved.tracks)
    # Track by volume is fluence: of eight fine cells together what it is in one. The outermost are
    # read by nobody; their track lacks what neighbours outside would leave in them.
    truth = outer[:, 5:11, 5:11, 7:13]
    whole = found.reshape(3, 8, 2, 8, 2, 8, 2).sum(axis=(2, 4, 6))[:, 1:-1, 1:-1, 1:-1]
    assert whole.sum() == pytest.approx(truth.sum(), rel=off)
    assert error(whole, truth) < 2.0 * off


def test_no_light_comes_from_beyond_the_larger_lattice(nest):
    inner = Placement((11.0, 7.0, 8.5), 0.5, (8, 8, 10))
    outer, found = nest(inner, sources(5), FOG).sums
    assert outer.any()
    assert not found.any()
