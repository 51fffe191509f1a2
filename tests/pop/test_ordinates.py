"""The scene's distant light: directional lights first, then the map, turned with it."""

from __future__ import annotations

import re
from importlib import resources

import numpy as np
import pytest

from airlight.maths.beam_phase import PHASE_TABLE
from airlight.maths.ordinates import parallel, uniform_sky
from airlight.pop.light.ordinates import SceneOrdinates
from airlight.pop.light.table import Kind, OrdinateTable
from airlight.pop.medium.placement import placed
from airlight.scene.environment import Environment
from airlight.scene.lights import DirectionalLight, PointLight
from airlight.scene.volume import Volume


def test_directional_lights_come_first_and_local_ones_not_at_all():
    sun = DirectionalLight((0, -1, 0), (1, 2, 3))
    got = SceneOrdinates(4).of((PointLight((0, 0, 0), (1, 1, 1)), sun), Environment((1, 1, 1)))
    assert got.count == 5
    np.testing.assert_allclose(got.direction[0], (0, -1, 0))
    np.testing.assert_allclose(got.irradiance[1:].sum(axis=0), 4 * np.pi)
    assert SceneOrdinates(4).of((), None).count == 0
    assert SceneOrdinates(4).of((), Environment((0, 0, 0))).count == 0


def test_the_map_turns_with_its_environment():
    lit = np.zeros((16, 32, 3), np.float32)
    lit[8, 16] = 5.0  # u = .5: towards +z, just below the horizon
    straight, turned = (
        SceneOrdinates(2).of((), Environment(map=lit, rotation_deg=angle)) for angle in (0.0, 90.0)
    )
    a, b = (o.direction[int(np.argmax(o.irradiance[:, 0]))] for o in (straight, turned))
    assert a @ (0, 0, -1) > 0.98  # travels away from +z
    # +z turned counter-clockwise about +Y, seen from above, is +x.
    assert b @ (-1, 0, 0) > 0.98


def test_a_table_scales_by_the_brightest_and_refuses_more_than_it_holds(gpu):
    box = Volume((1.0,) * 3, shape="box", g=(0.0, 0.5, 0.9))
    at = placed(box, 4)
    table = OrdinateTable(gpu, 3, prefilter=True)
    sky = parallel([(0, 0, 1), (0, 1, 0)], [(2, 4, 8), (1, 1, 1)])
    table.write(sky, [PointLight((0.1, 0.2, 0.3), (1, 1, 1))], at, box.g)
    assert (table.scale, table.count) == (8.0, 3)
    rows = table.rows.read().reshape(-1, 16)
    np.testing.assert_allclose(rows[0, :8], (0, 0, 1, 1, 0.25, 0.5, 1.0, 0.0))
    np.testing.assert_allclose(rows[2, 8:12], (1.1, 1.2, 1.3, 1.0), rtol=1e-6)
    phase = table.phase.read().reshape(-1, PHASE_TABLE, 4)[0, :, :3]
    assert phase[0, 2] > phase[-1, 2]
    with pytest.raises(ValueError, match="4 ordinates in a table of 3"):
        table.write(uniform_sky(4), (), at, box.g)


@pytest.mark.parametrize("made_by", ["partition", "importance"])
def test_a_turning_map_turns_its_ordinates_and_nothing_else(made_by):
    """What would flicker is a set of directions that changes from frame to frame."""
    lit = np.random.default_rng(1).random((32, 64, 3)).astype(np.float32) ** 8
    skies = SceneOrdinates(16, made_by)
    first = skies.of((), Environment(map=lit, rotation_deg=0.0))
    for angle in (0.1, 7.0, 180.0):
        turned = skies.of((), Environment(map=lit, rotation_deg=angle))
        np.testing.assert_array_equal(turned.irradiance, first.irradiance)
        np.testing.assert_allclose(turned.direction[:, 1], first.direction[:, 1], atol=1e-12)
        cosine = (turned.direction[:, [0, 2]] * first.direction[:, [0, 2]]).sum(axis=1)
        flat = (first.direction[:, [0, 2]] ** 2).sum(axis=1)
        np.testing.assert_allclose(cosine / flat, np.cos(np.radians(angle)), atol=1e-9)
    brighter = skies.of((), Environment(map=lit, scale=2.0))
    np.testing.assert_allclose(brighter.irradiance.sum(), 2 * first.irradiance.sum())


def test_kinds_are_numbered_as_in_wgsl():
    text = resources.files("airlight.wgsl").joinpath("ordinate_kind.wgsl").read_text("utf-8")
    numbers = dict(re.findall(r"const (\w+) = ([\d.]+);", text))
    assert {name: float(n) for name, n in numbers.items()} == {k.name: k.value for k in Kind}
