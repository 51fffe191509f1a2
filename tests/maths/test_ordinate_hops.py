"""Hops against Monte Carlo on the seven cubes, the paper's own over-count, and conservation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from airlight.maths import delta_beam as db
from airlight.maths import ordinate_hops as hop
from airlight.maths.phase import henyey_greenstein
from airlight.maths.transforms import F64

from .pop_cubes import CUBES, VIEWS, Cube, intensity, medium

GROUPS = (([0, 1, 2], (0, 1, 2)), ([3, 4, 5], (0, 1, 2)), ([6, 0, 0], (0,)))
FLUENCE = (0.12, 0.12, 0.10, 0.10, 0.23, 0.11, 0.20)
"""At most the relative L2 of scattered fluence at 16^3. A prototype of the split scheme, whose hops
were as long as the light's path, had .12, .29, .15, .21, .43, .16, .17."""
HELD_OUT = (
    (2, 1, 0.7),
    (2, 1, 0.9),
    (16, 1, 0.7),
    (16, 1, 0.9),
    (8, 1, 0.5),
    (5, 0.8, 0.7),
    (5, 0.8, 0.9),
    (12, 0.8, 0.9),
    (20, 0.95, 0.96),
)
"""sigma_t, albedo, g of cubes that no constant was fitted on."""


class Solved:
    """One group of cubes as the channels of a medium, light along +z."""

    def __init__(self, group: Sequence[int | Cube], cells: int, *, is_paper: bool = False) -> None:
        self.air = medium([CUBES[i] if isinstance(i, int) else i for i in group], cells)
        rho, h = self.air.density, 1.0 / cells
        hops = hop.parallel_hops((cells,) * 3, h)
        light = hop.first_light(hops, self.air, rho, np.ones((*rho.shape, 3)), is_paper=is_paper)
        done = hop.propagate(
            hops,
            self.air,
            rho,
            light,
            1.0,
            [np.full(rho.shape, v[2]) for v in VIEWS],
            is_paper=is_paper,
            iterations=3 * cells // 2,
        )
        self.fluence, self.seen, self.exits = done.fluence, list(done.seen), done.exits
        if not is_paper:
            self._add_residuum(done)

    def _add_residuum(self, done: hop.Propagated) -> None:
        air, cells = self.air, self.air.count[2]
        carried = np.zeros((3, *done.carried.shape))
        carried[2] = done.carried
        phi, flux = hop.residual_light(air, done.residual, carried)
        out = db.diffusion_of(air).exits(phi, carried)
        self.exits = self.exits + np.stack([out[4], out[5], out[:4].sum(axis=0)])
        self.fluence = self.fluence + phi
        depth = np.arange(cells + 1)[:, None] / cells * air.sigma_t
        beam = -np.diff(np.exp(-depth), axis=0) / (air.sigma_t / cells)
        for k, view in enumerate(VIEWS):
            direct = beam[:, None, None] * henyey_greenstein(view[2], air.g)
            rest = hop.residual_emission(air, phi, flux, np.array(view))
            self.seen[k] = self.seen[k] + direct + rest

    def brightness(self) -> F64:
        """(view, channel), W sr^-1."""
        return np.array([intensity(self.air, s, v) for s, v in zip(self.seen, VIEWS, strict=True)])


@pytest.mark.parametrize("cells", [8, 16])
def test_split_has_the_brightness_fluence_and_exits_of_monte_carlo(cells):
    """Brightness: measured .116, .137; exits off by .05 on average; means within 12 %."""
    logs, means, exits = [], [], []
    for group, channels in GROUPS:
        done = Solved(group, cells)
        brightness = done.brightness()
        for c in channels:
            cube = CUBES[group[c]]
            logs.append(np.log(brightness[:, c] / cube.intensity))
            means.append(done.fluence[..., c].mean() / cube.fluence)
            exits.append(done.exits[:, c] - cube.exits)
    assert np.abs(logs).mean() < 0.15
    assert np.abs(exits).mean() < 0.055
    # Light goes forwards and not sideways, most at g = .96.
    assert np.abs(exits).max() < 0.19
    assert np.abs(np.log(means)).mean() < 0.07
    assert max(means) < 1.14
    assert min(means) > 0.9


def test_the_papers_scheme_counts_light_many_times():
    """After 24 hops at 16^3: 6 to 17 times too bright, most in thin air."""
    done = Solved([0, 1, 3], 16, is_paper=True)
    over = done.fluence.mean(axis=(0, 1, 2)) / [CUBES[i].fluence for i in (0, 1, 3)]
    assert over.min() > 6.0
    assert over.max() < 18.0


@pytest.mark.parametrize(("g", "truth"), [(0.0, 0.859), (0.7, 0.889), (0.96, 0.952)])
def test_the_papers_hops_are_near_where_cells_start_with_what_scatters(g: float, truth: float):
    """A reading of Elek2014 4.1: the beam apart, a hop for each cell along the light.

    A unit cube of 4 per metre; `truth`: mean fluence with the beam, by 400,000 photons.
    """
    one = np.ones((16,) * 3)
    air = db.MediumGrid(np.ones(3), one, one, np.array([4.0]), np.ones(1), np.array([g]))
    hops, lit = hop.parallel_hops((16,) * 3, 1.0 / 16.0), np.ones((*one.shape, 1))
    found = []
    for is_paper, a in ((False, g), (True, 1.0)):
        power = hop.first_light(hops, air, one, lit, is_paper=is_paper)
        done = hop.propagate(hops, air, one, power, a, [], is_paper=True, iterations=16)
        found.append(done.fluence.mean())
    beam = (1.0 - np.exp(-4.0)) / 4.0
    # The notebook's table, where half of a cell's first light counts, has 1.08, 1.20 and 1.09.
    assert (found[0] + beam) / truth == pytest.approx(1.07, abs=0.14)
    assert found[1] / truth > 3.0


def test_a_lobe_s_way_is_shorter_than_hops_along_the_axes():
    """The mean of 1/(|x| + |y| + |z|) over lobes, sampled through their cumulative function."""
    u, phi = (np.arange(2000) + 0.5) / 2000, (np.arange(45) + 0.5) / 90.0 * np.pi
    for a in (0.1, 0.5, 0.8, 0.95):
        t = (1.0 - a * a) / (1.0 - a + 2.0 * a * u)
        mu = np.clip((1.0 + a * a - t * t) / (2.0 * a), -1.0, 1.0)[:, None]
        across = np.sqrt(1.0 - mu * mu) * (np.abs(np.cos(phi)) + np.abs(np.sin(phi)))
        want = (1.0 / (np.abs(mu) + across)).mean()
        assert hop.straight_path(np.array(a)) == pytest.approx(want, abs=0.01)
    assert hop.straight_path(np.array(1.0)) == 1.0


def test_no_light_is_lost_or_made():
    air = medium([CUBES[0], CUBES[1], CUBES[4]], 8)
    hops = hop.parallel_hops((8, 8, 8), 0.125)
    light = hop.first_light(hops, air, air.density, np.ones((8, 8, 8, 3)), is_paper=False)
    want = 1.0 - np.exp(-air.sigma_t)
    np.testing.assert_allclose(light.sum(axis=(0, 1, 2)), want)
    done = hop.propagate(hops, air, air.density, light, 1.0, [], iterations=5)
    out = done.exits.sum(axis=0) + done.residual.sum(axis=(0, 1, 2))
    np.testing.assert_allclose(out, want)


def test_absorption_takes_its_share_on_every_hop():
    """Light straight ahead, nothing scattered after the first time: exp(-sigma_a z) is left."""
    one = np.ones((10, 1, 1))
    air = db.MediumGrid(np.ones(3), one, one, np.full(3, 2.0), np.full(3, 0.5), np.full(3, 0.999))
    hops = hop.parallel_hops((1, 1, 10), 0.1)
    light = np.zeros((10, 1, 1, 3))
    light[0] = 1.0
    done = hop.propagate(hops, air, one, light, 1.0, [], iterations=12)
    assert done.exits[1, 0] == pytest.approx(np.exp(-0.9), rel=0.03)


def test_the_switch_is_where_anisotropy_has_fallen_to_a_tenth():
    m = hop.switch_iteration(1.0, 0.95, 1.0, 0.25)
    assert 0.95 ** (m * 0.25) == pytest.approx(0.1)
    assert hop.switch_iteration(0.05, 0.9, 1.0, 0.1) == 0.0
    assert hop.switch_iteration(1.0, 0.0, 1.0, 0.1) == 0.0
    assert hop.switch_iteration(1.0, 0.9, 0.0, 0.1) == float("inf")


def test_isotropic_hops_keep_their_power_until_it_leaves():
    light = np.zeros((9, 9, 9, 1))
    light[4, 4, 4] = 1.0
    total = hop.isotropic_hops(light, np.ones((9, 9, 9, 1)), 4)
    assert total.sum() == pytest.approx(4.0)
    assert total[4, 4, 4, 0] == pytest.approx(1 / 6 + 90 / 6**4)  # walks back after 2 and 4 hops


@pytest.mark.slow
@pytest.mark.parametrize("cells", [8, 16, 32])
@pytest.mark.needs("numba")
def test_split_has_the_fluence_of_monte_carlo(cells):
    """Relative L2: measured .128, .125, .135."""
    from airlight.reference.tracer import Beam, BoxMedium, trace

    errors = []
    for group, channels in GROUPS:
        done = Solved(group, cells)
        for c in channels:
            cube = CUBES[group[c]]
            sigma_t = cube.sigma_s + cube.sigma_a
            air = BoxMedium(sigma_t, cube.sigma_s / sigma_t, cube.g)
            side = min(cells, 16)
            want = trace(air, Beam((0, 0, 1)), cells=(side,) * 3, photons=300_000)
            f = cells // side
            got = done.fluence[..., c].reshape(side, f, side, f, side, f).mean(axis=(1, 3, 5))
            want = want.scattered_fluence
            errors.append(np.sqrt(((got - want) ** 2).sum() / (want**2).sum()))
    assert np.mean(errors) < 0.15, np.round(errors, 3)
    if cells == 16:
        assert np.all(np.array(errors) < np.array(FLUENCE)), np.round(errors, 3)


@pytest.mark.slow
@pytest.mark.parametrize("cells", [8, 16, 32])
@pytest.mark.needs("numba")
def test_split_is_as_good_where_nothing_was_fitted(cells):
    """Fluence: measured .13, .14, .16; brightness, |log|: .17, .19, .21, worst for thick air ahead.

    Delta beams have .12 and .10 on the same cubes at 16^3.
    """
    from airlight.reference.tracer import Beam, BoxMedium, trace

    errors, logs, means = [], [], []
    for first in range(0, len(HELD_OUT), 3):
        three = HELD_OUT[first : first + 3]
        group = [Cube(t * w, t * (1.0 - w), g, 0.0, (1.0,) * 3, (1.0,) * 3) for t, w, g in three]
        done = Solved(group, cells)
        brightness = done.brightness()
        for c, optics in enumerate(three):
            seen = trace(
                BoxMedium(*optics), Beam((0, 0, 1)), cells=(8,) * 3, photons=150_000, views=VIEWS
            )
            f = cells // 8
            got = done.fluence[..., c].reshape(8, f, 8, f, 8, f).mean(axis=(1, 3, 5))
            want = seen.scattered_fluence
            errors.append(np.linalg.norm(got - want) / np.linalg.norm(want))
            means.append(got.mean() / want.mean())
            logs.append(np.log(brightness[:, c] / seen.brightness.sum(axis=0)))
    assert np.mean(errors) < 0.18, np.round(errors, 3)
    assert np.abs(logs).mean() < 0.24, np.round(logs, 2)
    assert 0.75 < min(means) < max(means) < 1.2, np.round(means, 2)


@pytest.mark.slow
def test_the_papers_scheme_is_too_bright_in_every_cube():
    """Mean fluence of the seven cubes at 16^3 over Monte Carlo's; less in thick air."""
    over = []
    for group, channels in GROUPS:
        done = Solved(group, 16, is_paper=True)
        fluence = done.fluence.mean(axis=(0, 1, 2))
        over += [fluence[c] / CUBES[group[c]].fluence for c in channels]
    assert min(over) > 1.2  # thick air, whose T stops the count
    assert 13.0 < max(over) < 18.0
