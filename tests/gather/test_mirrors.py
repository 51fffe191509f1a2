"""What smooth surfaces mirror in a gathered image, against closed forms and a mirrored camera."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.gather.mirrors import Mirrors
from airlight.maths.area_light import cosine_table
from airlight.rendering import render
from airlight.scene import Camera, DirectionalLight, Environment, Material, Scene

from .panels import LPV, X, Y, Z, rectangle

SIZE = (48, 32)
GATHERED = {**LPV, "gather": "still"}


def albedo_at_normal(alpha: float) -> float:
    """Of a metal that reflects all: the table's first column by rows of roughness."""
    table = cosine_table()
    row = np.sqrt(alpha) * (len(table) - 1)
    low = int(row)
    own = table[low, 0, 4:6].sum() * (1.0 - row + low)
    return float(own + table[min(low + 1, len(table) - 1), 0, 4:6].sum() * (row - low))


@pytest.mark.parametrize("roughness", [0.0, 0.3, 0.6])
def test_metal_under_a_uniform_sky_reflects_its_albedo(roughness):
    """A floor seen from above, with nothing else to meet: all of it is the sky's light."""
    metal = Material(base_color=(1.0, 1.0, 1.0), metallic=1.0, roughness=roughness)
    floor = rectangle(-2 * X - 2 * Z, 4 * X, 4 * Z, metal)
    above = Camera((0.0, 9.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), 8.0)
    scene = Scene((floor,), (), Environment((0.5, 0.75, 1.0)), camera=above)
    image = render(scene, "lpv", SIZE, samples=2, settings=GATHERED)
    expected = albedo_at_normal(max(roughness**2, 0.002)) * np.array([0.5, 0.75, 1.0])
    np.testing.assert_allclose(image.radiance, np.tile(expected, (*SIZE[::-1], 1)), rtol=0.02)


def test_a_mirror_shows_what_a_mirrored_camera_sees():
    """A wall in three colours stands on a mirror; a camera below the mirror sees it directly.

    The light goes along the floor, so that the wall alone is lit.
    """
    paints = [(0.5, 0.1, 0.1), (0.1, 0.5, 0.1), (0.1, 0.1, 0.5)]
    wall = [
        rectangle((k - 1.5) * X + 0.5 * Y - Z, X, Y, Material(base_color=paint, specular=0.0))
        for k, paint in enumerate(paints)
    ]
    mirror = Material(base_color=(1.0, 1.0, 1.0), metallic=1.0, roughness=0.0)
    floor = rectangle(-3 * X - 3 * Z, 6 * X, 6 * Z, mirror)
    light = DirectionalLight((0.0, 0.0, -1.0), (3.0, 3.0, 3.0))
    camera = Camera((0.0, 1.5, 3.0), (0.0, -1.0, -1.0), (0.0, 1.0, 0.0), 25.0)
    scene = Scene((floor, *wall), (light,), camera=camera)
    shown = render(scene, "lpv", SIZE, samples=4, settings={**GATHERED, "bounces": False})
    below = Camera((0.0, -1.5, 3.0), (0.0, 1.0, -1.0), (0.0, 1.0, 0.0), 25.0)
    alone = replace(scene, meshes=tuple(wall), camera=below)
    truth = render(alone, "direct", SIZE, samples=4).radiance[::-1]
    assert truth.max() > 0.05
    # Of dark paint: what falls back onto the wall from the floor is little.
    inside = truth.sum(axis=-1) > 0.5 * truth.sum(axis=-1).max()
    ratio = shown.radiance[inside].sum(axis=0) / truth[inside].sum(axis=0)
    np.testing.assert_allclose(ratio, 1.0, atol=0.06)
    error = shown.radiance[inside] - truth[inside]
    assert np.sqrt((error**2).sum() / (truth[inside] ** 2).sum()) < 0.1


def test_a_mirror_in_a_mirror_shows_what_a_twice_mirrored_camera_sees():
    """The floor shows a mirror that stands on it, and in that a wall in three colours.

    Two reflections are half a turn about the line where both mirrors meet.
    """
    paints = [(0.5, 0.1, 0.1), (0.1, 0.5, 0.1), (0.1, 0.1, 0.5)]
    wall = [
        rectangle(2 * X + (k - 1.5) * Z + 3.5 * Y, Z, -3 * Y, Material((*paint,), specular=0.0))
        for k, paint in enumerate(paints)
    ]
    mirror = Material(base_color=(1.0, 1.0, 1.0), metallic=1.0, roughness=0.0, two_sided=True)
    floor = rectangle(-2 * X - 3 * Z, 3.5 * X, 6 * Z, mirror)
    standing = rectangle(-2 * X - 3 * Z + 1.2 * Y, 6 * Z, -1.2 * Y, mirror)
    light = DirectionalLight((1.0, -0.4, 0.0), (3.0, 3.0, 3.0))
    camera = Camera((1.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 20.0)
    turned = Camera((-5.0, -1.0, 0.0), (-3.0, 0.0, 0.0), (0.0, -1.0, 0.0), 20.0)
    scene = Scene((floor, standing, *wall), (light,), camera=camera)
    shown = render(scene, "lpv", SIZE, samples=4, settings={**GATHERED, "bounces": False})
    truth = render(Scene(tuple(wall), (light,), camera=turned), "direct", SIZE, samples=4).radiance
    inside = truth.sum(axis=-1) > 0.5 * truth.sum(axis=-1).max()
    assert inside.mean() > 0.5
    ratio = shown.radiance[inside].sum(axis=0) / truth[inside].sum(axis=0)
    np.testing.assert_allclose(ratio, 1.0, atol=0.06)
    error = shown.radiance[inside] - truth[inside]
    assert np.sqrt((error**2).sum() / (truth[inside] ** 2).sum()) < 0.15


@pytest.mark.parametrize("roughness", [0.1, pytest.param(0.3, marks=pytest.mark.slow)])
def test_a_coat_in_a_mirror_shines_as_it_does_to_a_mirrored_camera(roughness):
    """A dark floor in a mirror that stands on it, under a uniform sky: its coat grazes the eye.

    As paint it would show a quarter of that.
    """
    mirror = Material(base_color=(1.0, 1.0, 1.0), metallic=1.0, roughness=0.0)
    coated = Material(base_color=(0.0, 0.0, 0.0), roughness=roughness)
    floor = rectangle(-9 * X - 9 * Z, 18 * X, 18 * Z, coated)
    standing = rectangle(-2 * X + 2 * Y, 4 * X, -2 * Y, mirror)
    camera = Camera((0.0, 1.0, 3.0), (0.0, 0.5, 0.0), (0.0, 1.0, 0.0), 5.0)
    sky = Environment((1.0, 1.0, 1.0))
    scene = Scene((floor, standing), (), sky, camera=camera)
    shown = render(scene, "lpv", SIZE, samples=8, settings=GATHERED).radiance
    behind = Camera((0.0, 1.0, -3.0), (0.0, 0.5, 0.0), (0.0, 1.0, 0.0), 5.0)
    alone = Scene((floor,), (), sky, camera=behind)
    truth = render(alone, "lpv", SIZE, samples=8, settings=GATHERED).radiance
    # .434 for .434, and .276 for .286.
    assert truth.mean() > 0.15
    assert shown.mean() == pytest.approx(truth.mean(), rel=0.08)


def test_a_panel_is_seen_in_a_mirror_in_a_mirror():
    """The same two mirrors, and nothing but a panel that glows towards them, or away."""
    mirror = Material(base_color=(1.0, 1.0, 1.0), metallic=1.0, roughness=0.0, two_sided=True)
    floor = rectangle(-2 * X - 3 * Z, 3.5 * X, 6 * Z, mirror)
    mirrors = (floor, rectangle(-2 * X - 3 * Z + 1.2 * Y, 6 * Z, -1.2 * Y, mirror))
    camera = Camera((1.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 8.0)
    glow = (2.0, 1.0, 0.5)
    paint = Material(base_color=(0.0, 0.0, 0.0), specular=0.0, emission=glow, two_sided=False)
    panels = (
        rectangle(2 * X - 1.5 * Z + 3.5 * Y, 3 * Z, -3 * Y, paint),
        rectangle(2 * X + 1.5 * Z + 3.5 * Y, -3 * Z, -3 * Y, paint),
    )
    shown = [
        render(Scene((*mirrors, panel), camera=camera), "lpv", SIZE, samples=4, settings=GATHERED)
        for panel in panels
    ]
    medians = [np.median(image.radiance.reshape(-1, 3), axis=0) for image in shown]
    dark, bright = sorted(medians, key=lambda rgb: rgb.sum())
    np.testing.assert_allclose(bright, glow, rtol=0.06)
    assert max(dark) < 0.02


@pytest.mark.parametrize(("roughness", "share"), [(0.2, 1.0), (0.5, 0.25)])
def test_rough_pixels_of_a_block_share_a_ray_and_smooth_ones_send_their_own(
    monkeypatch, roughness, share
):
    """A flat floor of metal; all pixels mirror."""
    seen = []
    encode = Mirrors.encode

    def watched(self, commands, *args):
        found = encode(self, commands, *args)
        commands.submit()
        seen.append(int(self._sized.found.read(np.uint32)[0]))
        return found

    monkeypatch.setattr(Mirrors, "encode", watched)
    metal = Material(base_color=(1.0, 1.0, 1.0), metallic=1.0, roughness=roughness)
    floor = rectangle(-20 * X - 20 * Z, 40 * X, 40 * Z, metal)
    above = Camera((0.0, 9.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), 8.0)
    scene = Scene((floor,), (), Environment((0.5, 0.75, 1.0)), camera=above)
    render(scene, "lpv", SIZE, samples=4, settings=GATHERED)
    assert len(seen) >= 4
    assert set(seen) == {round(share * SIZE[0] * SIZE[1])}


def test_mirrors_are_the_same_in_batches_of_any_size(monkeypatch):
    """Two mirrors that face each other, so that paths go on in all segments."""
    mirror = Material(base_color=(0.9, 0.8, 0.7), metallic=1.0, roughness=0.1)
    walls = [rectangle(x * X - Y - Z, 2 * Y, 2 * Z, mirror) for x in (-1.0, 1.0)]
    light = DirectionalLight((0.3, -1.0, 0.2), (3.0, 3.0, 3.0))
    paint = Material(base_color=(0.5, 0.4, 0.3), specular=0.0)
    floor = rectangle(-X - Y - Z, 2 * X, 2 * Z, paint)
    camera = Camera((0.0, 0.3, 0.9), (0.5, -0.2, -0.5), (0.0, 1.0, 0.0), 70.0)
    scene = Scene((*walls, floor), (light,), Environment((0.2, 0.3, 0.4)), camera=camera)
    images = []
    for most in (1 << 17, 7 * SIZE[0]):
        monkeypatch.setattr("airlight.gather.mirror_batches.MOST_HITS", most)
        images.append(render(scene, "lpv", SIZE, samples=2, settings=GATHERED))
    for name in ("direct", "indirect"):
        np.testing.assert_array_equal(images[0].layers[name], images[1].layers[name])
