"""Single scattering of a sky is exact in thin air, turned maps included, with few ordinates."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.maths.latlong import latlong_row_solid_angles, latlong_texel_directions
from airlight.maths.phase import henyey_greenstein
from airlight.maths.transforms import F64
from airlight.pop.light.illumination import Illumination
from airlight.pop.light.sky_correction import SkyCorrection
from airlight.pop.settings import PopSettings
from airlight.pop.solver import PopSolver
from airlight.scene import Environment, Volume

G = 0.93
TURNED = np.array([[0.6, 0, 0.8, 0], [0, 1, 0, 0], [-0.8, 0, 0.6, 0], [0, 0, 0, 1.0]])
THIN = Volume((1e-4,) * 3, shape="box", g=(G,) * 3, world_from_volume=TURNED)


def emitted(gpu: Gpu, sky: Environment, eye: F64, **settings: object) -> float:
    """Mean radiance scattered towards a far eye."""
    solver = PopSolver(gpu, THIN, PopSettings(ordinates=24, grid=4, solver_steps=4, **settings))
    commands = Commands(gpu)
    solver.encode(commands, Illumination((), sky, 1e4 * eye))
    commands.submit()
    value = solver.emission.texture.read()[..., 0].astype(float).mean() * solver.scale
    return float(value)


def test_a_glow_in_a_turned_map_is_seen_as_it_is(gpu):
    towards = latlong_texel_directions(48, 96)
    glow = np.array([0.3, 0.4, -0.866])
    lit = 0.1 + 4.0 * np.maximum(towards @ glow, 0.0)[..., None] ** 60 * np.ones(3)
    angle = 40.0
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    about_y = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    sky = Environment(map=lit.astype(np.float32), rotation_deg=angle)
    power = lit[..., 0] * latlong_row_solid_angles(48, 96)[:, None]
    errors: dict[bool, list[float]] = {True: [], False: []}
    for off in (np.zeros(3), [0.2, 0.1, 0.0], [-0.3, 0.2, 0.3], [1.0, -1.0, 1.0]):
        behind = glow + off
        behind /= np.linalg.norm(behind)
        want = float((henyey_greenstein(towards @ behind, G) * power).sum())
        for is_exact, found in errors.items():
            got = emitted(gpu, sky, -(about_y @ behind), exact_sky=is_exact, furnace_correction=0.0)
            found.append(abs(got / want - 1.0))
    assert max(errors[True]) < 0.04
    assert max(errors[False]) > 0.1


def test_without_a_sky_it_is_one(gpu):
    gain = SkyCorrection(gpu)
    gain.write(
        None, PopSolver(gpu, THIN, PopSettings(grid=4)).medium.placement, THIN.g, prefilter=True
    )
    assert gain.texture.read()[..., :3] == pytest.approx(1.0)
