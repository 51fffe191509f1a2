"""Light of a lattice in a medium: an even lattice is a uniform sky."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.fields import LatticeSource, ReflectedLight
from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.lattice.placement import Fade, Placement
from airlight.maths.transforms import F64
from airlight.pop.light.illumination import Illumination
from airlight.pop.settings import PopSettings
from airlight.pop.solver import PopSolver
from airlight.scene import Environment, Volume

SETTINGS = PopSettings(ordinates=16, grid=8, solver_steps=24)
EYE = np.array([3.0, 1.0, 2.0])


def lattice(gpu: Gpu, state: tuple[float, float, float, float], scale: float) -> LatticeSource:
    """The same state in all of 8 m around the origin."""
    textures = {}
    values = {name: state for name in ("red", "green", "blue")}
    for name, value in {
        **values,
        "visibility_a": (1,) * 4,
        "visibility_b": (1,) * 4,
        "walls": (0,) * 4,
    }.items():
        made = Texture(gpu, name, (8, 8, 8), "rgba16float", dimension="3d")
        made.write(np.tile(np.array(value, np.float16), (8, 8, 8, 1)))
        textures[f"lattice_{name}"] = made
    return LatticeSource(Placement((-4.0,) * 3, 1.0, (8, 8, 8)), textures, scale=scale)


def emission(gpu: Gpu, volume: Volume, source: LatticeSource | None, sky: float = 0.0) -> F64:
    """Mean radiance that the cells inside the medium scatter."""
    solver, commands = PopSolver(gpu, volume, SETTINGS), Commands(gpu)
    environment = Environment((sky,) * 3) if sky else None
    bounced = ReflectedLight(source, ()) if source else None
    solver.encode(commands, Illumination((), environment, EYE, reflected=bounced))
    commands.submit()
    inside = solver.medium.density.cells.read().reshape(solver.medium.placement.count[::-1]) > 0.5
    texels = solver.emission.texture.read()[..., :3].astype(np.float64)
    return np.asarray(texels[inside] * solver.scale)


def test_what_does_not_absorb_passes_the_lattice_on(gpu):
    ball = Volume((4.0,) * 3, shape="sphere", g=(0.0, 0.5, 0.9))
    got = emission(gpu, ball, lattice(gpu, (2.0, 0, 0, 0), 0.75))
    np.testing.assert_allclose(got, 1.5, rtol=2e-3)
    assert emission(gpu, ball, None).max() == 0.0


def test_of_nested_lattices_each_has_what_it_is_for(gpu):
    """Beside a finer one all of the light is the larger one's, whose power is in larger cells."""
    ball = Volume((4.0,) * 3, shape="sphere")
    source = lattice(gpu, (2.0, 0, 0, 0), 0.75)
    far = Placement((50.0,) * 3, 0.5, (8, 8, 8), fade=Fade((50.0,) * 3, (1.0,) * 3, (54.0,) * 3,
                                                          (1.0,) * 3))  # fmt: skip
    near = replace(far, origin=(-2.0,) * 3, fade=Fade((-3.0,) * 3, (0.1,) * 3, (3.0,) * 3,
                                                     (0.1,) * 3))  # fmt: skip
    beside = emission(gpu, ball, replace(source, finer=(far,)))
    np.testing.assert_allclose(beside, 1.5, rtol=2e-3)
    inside = emission(gpu, ball, replace(source, finer=(near,)))
    np.testing.assert_allclose(inside, 1.5 * 4.0, rtol=2e-3)


def test_an_even_lattice_is_an_uniform_sky(gpu):
    """In the mean; of the sky's light it is known how it leans, which absorption makes it do."""
    sooty = Volume((4.0,) * 3, shape="sphere", albedo=(0.9, 0.7, 0.3), g=(0.5,) * 3)
    got = emission(gpu, sooty, lattice(gpu, (1.0, 0, 0, 0), 2.0)).mean(axis=0)
    want = emission(gpu, sooty, None, sky=2.0).mean(axis=0)
    assert want[2] < 0.6 * want[0]
    np.testing.assert_allclose(got, want, rtol=0.15)


def test_a_lattice_that_leans_is_seen_to(gpu):
    """With g, light that travels towards the eye is scattered on."""
    ball = Volume((4.0,) * 3, shape="sphere", g=(0.0, 0.4, 0.8))
    towards = EYE / np.linalg.norm(EYE)
    got = emission(gpu, ball, lattice(gpu, (1.0, *towards), 1.0)).mean(axis=0)
    assert got == pytest.approx(1.0 + np.array([0.0, 0.4, 0.8]), rel=0.05)
