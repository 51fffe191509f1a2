"""Lights as shaders see them."""

from __future__ import annotations

import math

import pytest

from airlight.gpu.layout import pack_array
from airlight.scene import DirectionalLight, PointLight, SpotLight
from airlight.surface.light_table import LightData, light_rows, packed_lights

SUN = DirectionalLight((0, -2, 0), (1, 2, 3))
LIGHT = PointLight((1, 2, 3), (4, 5, 6))
SPOT = SpotLight((0, 1, 0), (0, 0, -1), (7, 8, 9), inner_deg=60, outer_deg=70)


def test_rows_carry_what_the_lights_say():
    table = pack_array(LightData, light_rows((SUN, LIGHT, SPOT)))
    assert table["kind"].tolist() == [0, 1, 2]
    assert table["color"].tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert table["direction"][0].tolist() == [0, -1, 0]
    assert table["position"][1].tolist() == [1, 2, 3]
    assert table["shape_x"][2] == pytest.approx(math.cos(math.radians(60)))
    assert table["shape_y"][2] == pytest.approx(math.cos(math.radians(70)))


def test_parallel_and_local_views_are_counted_apart():
    rows = light_rows((LIGHT, SUN, SPOT, SUN, LIGHT))
    assert [row["first_view"] for row in rows] == [0, 0, 6, 1, 12]
    assert [row["view_count"] for row in rows] == [6, 1, 6, 1, 6]


def test_no_lights_still_make_a_table():
    assert len(pack_array(LightData, light_rows(()))) == 1


def test_the_same_lights_are_packed_once():
    sky = tuple(DirectionalLight((0, -1, 0), (i, 0, 0)) for i in range(1, 30))
    table = packed_lights(sky)
    assert table.tobytes() == pack_array(LightData, light_rows(sky)).tobytes()
    assert not table.flags.writeable
    for i in range(20):  # a sun that moves beside it
        sun = (DirectionalLight((0, -1, 0.1 * i), (1, 2, 3)),)
        assert packed_lights(sun).tobytes() == pack_array(LightData, light_rows(sun)).tobytes()
        assert packed_lights(tuple(sky)) is table
    other = (*sky[:-1], LIGHT)
    assert packed_lights(other)["kind"][-1] == 1
