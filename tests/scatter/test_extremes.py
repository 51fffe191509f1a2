"""Solved fields in any air: finite, not negative, and no more absorbed than was put in."""

import numpy as np
import pytest

from airlight.scatter.schedule import ACCELERATIONS, schedule
from airlight.scatter.state_sum import LatticeKind, StateSum

from .test_propagate import packed_faces  # type: ignore[import-not-found]

COUNT = (12, 10, 8)
SHAPE = COUNT[::-1]
DEPTHS = ((0.01, 0.03, 0.1), (0.3, 1.0, 2.0), (3.0, 6.0, 10.0))
ALBEDOS = (0.0, 0.3, 0.9, 0.99, 1.0)


def track_of(gpu, commands, lattice, source, plan, sigma_t, albedo, is_blocked):
    """(3, Z, Y, X): W m of track in cells of 1 m; walls half open at random, white 0.9."""
    states = StateSum(gpu, COUNT, 1.0, plan, LatticeKind(has_walls=is_blocked, is_varied=False))
    states.set_homogeneous(albedo * sigma_t, sigma_t)
    if is_blocked:
        rng = np.random.default_rng(3)
        faces = np.clip(3.0 * rng.random((6, *SHAPE)) - 1.0, 0.0, 1.0)
        white = np.full((*SHAPE, 4), 230, np.uint8)
        states.set_walls(commands, lattice(packed_faces(faces)), lattice(white.view(np.uint32)))
    _, track = states.encode(commands, lattice(source))
    commands.submit()
    return track.read().reshape(source.shape)[..., 0].astype(np.float64)


@pytest.mark.parametrize("is_blocked", [False, True], ids=["open", "walls"])
@pytest.mark.parametrize("acceleration", ACCELERATIONS)
def test_light_stays_finite_positive_and_bounded(gpu, commands, lattice, acceleration, is_blocked):
    source = np.zeros((3, *SHAPE, 4))
    source[..., 0] = np.random.default_rng(4).random((3, *SHAPE)) ** 8
    source[:, 4, 5, 6, 0] = 30.0
    power = source[..., 0].sum(axis=(1, 2, 3))
    plan = schedule(acceleration, 8)
    for depths in DEPTHS:
        for albedo in ALBEDOS:
            sigma_t = np.array(depths)
            track = track_of(gpu, commands, lattice, source, plan, sigma_t, albedo, is_blocked)
            case = f"depth {depths}, albedo {albedo}"
            assert np.isfinite(track).all(), case
            lowest = (track / track.max(axis=(1, 2, 3), keepdims=True)).min()
            assert lowest > -0.05, (case, lowest)  # marching clamps it
            absorbed = sigma_t * (1.0 - albedo) * track.sum(axis=(1, 2, 3))
            assert np.all(absorbed <= 1.02 * power), (case, absorbed / power)
