"""Tangents as one number beside a normal: there and back, sides, twins."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths.tangent_angle import STEPS, packed_normals, packed_tangents, tangent_of

RNG = np.random.default_rng(11)
COUNT = 20_000


def pairs():
    """Unit normals and tangents at right angles, also beside z = 0, where frames change."""
    n = RNG.normal(size=(COUNT, 3))
    n[:2000, 2] = RNG.uniform(-1e-5, 1e-5, 2000)
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    t = np.cross(n, RNG.normal(size=(COUNT, 3)))
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    return packed_normals(n), np.concatenate([t, RNG.choice([-1.0, 1.0], (COUNT, 1))], axis=1)


def test_there_and_back():
    """An angle is off by half a step at most, a normal by half of one of its own."""
    normals, tangents = pairs()
    back = tangent_of(normals, packed_tangents(normals, tangents))
    np.testing.assert_array_equal(back[:, 3], tangents[:, 3])
    error = np.linalg.norm(back[:, :3] - tangents[:, :3], axis=1).max()
    assert error < np.pi / (STEPS - 1) + np.sqrt(3.0) / STEPS


@pytest.mark.parametrize("tangent", [(0, 0, 0, 1), (0, 0, 2, 1), (1, 0, 0, 0)])
def test_what_is_no_tangent_is_none(tangent):
    normals = packed_normals([(0, 0, 1)])
    packed = packed_tangents(normals, [tangent])
    assert packed == 0
    assert not tangent_of(normals, packed).any()


def test_twin(wgsl):
    """Within what WGSL grants a sine, 2^-11."""
    normals, tangents = pairs()
    packed = packed_tangents(normals, tangents)
    packed[::7] = 0
    rows = np.concatenate([normals, packed[:, None]], axis=1) / float(STEPS)
    found = wgsl("tangent_angle", "tangent_of", rows, returns="vec4f")
    np.testing.assert_allclose(found, tangent_of(normals, packed), atol=2.0**-10)
