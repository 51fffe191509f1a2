"""wgsl/hops26.wgsl: its numbers are those of the NumPy tables, and its mean track is NumPy's."""

import re
from pathlib import Path

import numpy as np
import pytest

import airlight
from airlight.lattice.placement import Placement
from airlight.maths import lattice26, lattice26_walls
from airlight.maths.lattice26 import mean_track
from airlight.scatter.surface_light import SurfaceLight, SurfaceMedium

TEXT = (Path(airlight.__file__).parent / "wgsl" / "hops26.wgsl").read_text()


def constant(name: str) -> list[float]:
    """The numbers of a `const` of the file."""
    found = re.search(rf"^const {name} = (?:vec3f\()?([^;)]+)\)?;", TEXT, re.MULTILINE)
    assert found, name
    return [float(word) for word in found[1].split(",")]


@pytest.mark.parametrize("name", re.findall(r"^const (\w+)", TEXT, re.MULTILINE))
def test_numbers_are_those_of_the_tables(name):
    table, kinds = lattice26.hops(), [0, 6, 18]
    wanted = {
        "RHO": [lattice26.RHO],
        "HOP_WEIGHTS": table.weights[kinds],
        "HOP_LENGTHS": table.lengths[kinds],
        "MEAN_HOP": [lattice26.mean_hop_length()],
        "RETURNED": [lattice26_walls.returned_sharpness()],
        "REFLECTED_TRACK": [lattice26_walls.REFLECTED_TRACK],
        "SPLIT_FLOOR": [lattice26_walls.SPLIT_FLOOR],
    }
    # float32 rounds to 6e-8.
    np.testing.assert_allclose(constant(name), wanted[name], rtol=3e-8)


def test_mean_track_is_numpys(gpu, commands, lattice):
    """Through the pack for surfaces, the shorter of its readers."""
    sigma_t = (1e-3, 0.7, 9.0)
    placement = Placement((0.0, 0.0, 0.0), 0.4, (2, 2, 2))
    ones = np.zeros((3, 2, 2, 2, 4))
    ones[..., 0] = 1.0
    surfaces = SurfaceLight(gpu, placement)
    surfaces.encode(commands, lattice(ones), 1.0, SurfaceMedium(sigma_t=sigma_t))
    commands.submit()
    textures = (surfaces.red, surfaces.green, surfaces.blue)
    got = [t.read()[0, 0, 0, 0] / surfaces.scale for t in textures]
    want = mean_track(np.array(sigma_t), 0.4) / mean_track(0.0, 0.4)
    np.testing.assert_allclose(got, want, rtol=2e-3)
