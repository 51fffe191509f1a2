"""Damping against leaks (Kaplanyan2010 Fig. 3) in lattices whose light is known."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.memory import Texture, buffer_of, linear_sampler
from airlight.gpu.slots import sampler, storage, texture, uniform
from airlight.lattice.placement import LatticeParams, Placement

COUNT = (12, 6, 8)  # x, y, z

_KERNEL = """
//! use lattice
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < arrayLength(&strengths)) {
        let uvw = vec3f(6.0, 3.0, 4.0) / vec3f(lattice.count);
        factors[id.x] = lattice_damping(lattice, uvw, vec3f(1.0, 0.0, 0.0), strengths[id.x]);
    }
}
"""


@pytest.fixture
def damped(gpu, commands, owned, kernel):
    """damped(light along x) -> factor at strengths 0, 1 and 100, on a surface that faces +x."""

    def damp(along_x):
        states = np.zeros((*COUNT[::-1], 4), np.float16)
        states[..., 0] = along_x
        light = owned(Texture(gpu, "light", COUNT, "rgba16float", dimension="3d"))
        light.write(states)
        other = owned(Texture(gpu, "walls", COUNT, "rgba8snorm", dimension="3d"))
        strengths = owned(buffer_of(gpu, "strengths", np.array([0, 1, 100, 0], np.float32)))
        factors = owned(buffer_of(gpu, "factors", np.zeros(4, np.float32)))
        names = [
            f"lattice_{n}"
            for n in ("red", "green", "blue", "visibility_a", "visibility_b", "walls")
        ]
        slots = (
            uniform("lattice", LatticeParams),
            *(texture(name, "3d") for name in names),
            sampler("linear_clamp"),
            storage("strengths", "f32"),
            storage("factors", "f32", "read_write"),
        )
        bound = dict.fromkeys(names[:3], light) | dict.fromkeys(names[3:], other)
        kernel(_KERNEL, slots).dispatch(
            commands,
            (4,),
            lattice=Placement((0, 0, 0), 1.0, COUNT).params(1.0),
            **bound,
            linear_clamp=linear_sampler(gpu),
            strengths=strengths,
            factors=factors,
        )
        commands.submit()
        return factors.read()[:3]

    return damp


def test_even_light_and_light_from_before_the_surface_stay(damped):
    np.testing.assert_allclose(damped(np.full(12, 3.0)), 1.0, atol=1e-6)
    np.testing.assert_allclose(damped(np.linspace(1.0, 4.0, 12)), 1.0, atol=1e-6)


def test_light_that_falls_off_from_behind_is_damped(damped):
    # half of it gone in one cell; the surface stands in the middle of that cell's slope
    factor = damped(np.where(np.arange(12) < 6, 2.0, 1.0))
    assert factor[0] == 1.0
    assert factor[1] == pytest.approx(1.0 - 1.0 / 1.5, rel=1e-3)
    assert factor[2] == 0.0
