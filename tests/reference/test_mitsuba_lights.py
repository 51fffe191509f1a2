"""The spot's projected fall-off, and groups of points."""

from __future__ import annotations

import math

import numpy as np
import pytest

from airlight import AreaLight, PointLight, PointLights, Scene, SpotLight
from airlight.reference.mitsuba import write_mitsuba
from airlight.reference.mitsuba_files import FileStore
from airlight.reference.mitsuba_lights import light_elements, point_emitters
from airlight.scene.io.mitsuba import load_mitsuba
from airlight.scene.light_shapes import light_mesh
from airlight.scene.lights.spot import spot_pixels, spot_share


def test_the_fall_off_is_the_smoothstep_of_the_cosine() -> None:
    inner, middle, outer = (math.cos(math.radians(a)) for a in (20, 25, 30))
    values = spot_share(np.array([1.0, inner, middle, outer, 0.0]), 20, 30)
    t = (middle - outer) / (inner - outer)
    np.testing.assert_allclose(values, [1, 1, 3 * t**2 - 2 * t**3, 0, 0], atol=1e-12)


def test_the_projected_image_is_round_and_centred() -> None:
    pixels = spot_pixels(10, 40)[..., 0]
    np.testing.assert_array_equal(pixels, pixels.T)
    np.testing.assert_array_equal(pixels, pixels[::-1])
    assert pixels[512, 512] == 1.0 and pixels[0, 0] == 0.0


@pytest.mark.parametrize(("inner", "outer"), [(20, 30), (0, 60), (1, 89), (88, 89), (30, 31)])
def test_the_image_filtered_is_the_fall_off(inner: float, outer: float) -> None:
    pixels = spot_pixels(inner, outer)
    side = len(pixels)
    angle = np.linspace(0.0, math.radians(outer), 4001)[:-1]
    x = 0.5 + 0.5 * np.tan(angle) / math.tan(math.radians(outer))
    row = 0.5 * (pixels[side // 2 - 1, :, 0] + pixels[side // 2, :, 0])
    seen = np.interp(x * side - 0.5, np.arange(side), row)
    np.testing.assert_allclose(seen, spot_share(np.cos(angle), inner, outer), atol=0.005)


def test_a_group_is_a_point_emitter_for_each_of_its_lights(tmp_path) -> None:
    group = PointLights([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], [[0.5, 0.25, 0.0]])
    emitters = point_emitters(group, FileStore(tmp_path, "."))
    assert [e.get("type") for e in emitters] == ["point", "point"]
    places = [e.find("point[@name='position']") for e in emitters]
    assert [[float(p.get(axis)) for axis in "xyz"] for p in places] == group.positions.tolist()
    colour = emitters[1].find("rgb[@name='intensity']").get("value")
    assert [float(c) for c in colour.replace(",", " ").split()] == [0.5, 0.25, 0.0]


def test_area_lights_are_shapes_that_glow(tmp_path):
    notes: list[str] = []
    files = FileStore(tmp_path, ".")
    both = AreaLight((1, 2, 3), 5.0, direction=(0, 0, 1), up=(0, 1, 0), size=(2, 4), two_sided=True)
    front, back = light_elements(both, files, notes)
    assert front.get("type") == back.get("type") == "rectangle"
    matrix = front.find("transform/matrix").get("value")
    placed = np.array([float(x) for x in matrix.split()]).reshape(4, 4)
    np.testing.assert_allclose(placed[:3, 2], (0, 0, 1), atol=1e-9)
    np.testing.assert_allclose(placed[:3, 3], (1, 2, 3), atol=1e-9)
    # Mitsuba's rectangle is 2 m across: half of the width and height, right-handed.
    assert sorted(np.linalg.norm(placed[:3, :2], axis=0)) == pytest.approx([1.0, 2.0])
    assert np.linalg.det(placed[:3, :3]) > 0.0
    (ball,) = light_elements(PointLight((0, 1, 0), np.pi, radius=0.5), files, notes)
    assert ball.get("type") == "sphere"
    radiance = ball.find("emitter/rgb").get("value")
    assert float(radiance.split()[0].rstrip(",")) == pytest.approx(4.0)
    light_elements(SpotLight((0, 1, 0), (0, -1, 0), 1.0, radius=0.1), files, notes)
    assert len(notes) == 2


@pytest.mark.parametrize(
    "light",
    [
        AreaLight((1, 2, 3), (4, 5, 6), direction=(0.6, -0.8, 0), up=(0, 0, 1), size=(2, 0.5)),
        AreaLight((1, 2, 3), 4, "disk", direction=(1, 2, 2), radius=0.3, reflectance=(0.5, 0, 1)),
        AreaLight((1, 2, 3), 4, "sphere", radius=0.3, reflectance=0.25),
        AreaLight((1, 2, 3), 4, direction=(0, 0, 1), up=(0, 1, 0), two_sided=True),
        AreaLight((1, 2, 3), 4, "disk", visible=False, two_sided=True),
    ],
    ids=["rectangle", "disk", "sphere", "two-sided", "unseen"],
)
def test_an_area_light_comes_back_from_mitsuba(light, tmp_path):
    write_mitsuba(Scene(lights=(light,)), tmp_path / "scene.xml")
    read = load_mitsuba(tmp_path / "scene.xml")
    (back,) = read.lights
    assert not read.meshes
    same = ("shape", "two_sided", "visible", "radiance", "reflectance", "position")
    for name in same:
        assert getattr(back, name) == getattr(light, name), name
    there, here = light_mesh(light).world_bounds, light_mesh(back).world_bounds
    np.testing.assert_allclose(here, there, atol=1e-6)
    if light.shape != "sphere":
        np.testing.assert_allclose(back.direction, light.direction, atol=1e-6)
    assert back.area == pytest.approx(light.area)
