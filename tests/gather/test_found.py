"""What single rays find by luck is no blot: it counts little there, and the rest is spread."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from airlight.gather.found import _MOST, FoundSums
from airlight.gather.sums import PointSums
from airlight.gpu.memory import Texture, buffer_of
from airlight.maths.colour import luminance
from airlight.rendering import render
from airlight.scene import Camera, Material, Mesh, PointLight, Scene
from airlight.scene.shapes import box

SIZE, RAYS = (88, 72), 16
LUCKY = (40, 36)  # column and row of a point in the middle
KINDS = ("near", "far", "later")


@pytest.fixture
def found(gpu, commands, owned):
    """found(sums, sample) -> (H, W, layer, 4), what `FoundSums` makes of the sums of points."""

    def encode(sums, sample=0):
        places = Texture(gpu, "places", SIZE, "rgba32float", written=True)
        places.write(np.ones((SIZE[1], SIZE[0], 4), np.float32))
        orphans = buffer_of(gpu, "orphans", np.zeros(SIZE[0] * SIZE[1], np.uint32))
        points = SimpleNamespace(
            blocks=SIZE, reduced=SIZE, places=places, orphans=SimpleNamespace(buffer=orphans)
        )
        made = FoundSums(gpu, points, RAYS)
        held = buffer_of(gpu, "sums", sums.view(np.float32))
        image = made.encode(commands, SimpleNamespace(sample=sample), held)
        commands.submit()
        return np.stack([image.read(k) for k in range(11)], axis=2).astype(np.float64)

    return encode


def sums_with(kind, light):
    """Even sums, and in `kind` of one point what one ray found beside them."""
    sums = np.zeros((SIZE[1], SIZE[0]), PointSums.dtype)
    sums["near"], sums["near_flux"][..., 1], sums["brightest"] = RAYS, RAYS, 2.0
    one = sums[LUCKY[1], LUCKY[0]]
    one[kind] += np.float32(light)
    one[f"{kind}_flux"][0] += np.float32(luminance(np.asarray(light)))
    one["brightest"] = luminance(np.asarray(light))
    return sums


def whole(image):
    """Light of surfaces, whatever kind it is."""
    return sum(image[:, :, 2 * k, :3] for k in range(3))


@pytest.mark.parametrize("kind", KINDS)
def test_a_lucky_ray_counts_little_and_no_light_is_lost(found, kind):
    light = np.array([9000.0, 6000.0, 3000.0])
    sums = sums_with(kind, light)
    before = sum(sums[k].astype(np.float64) for k in KINDS)
    after = whole(found(sums))
    x, y = LUCKY
    # The mean of the rays around, of nine tiles of 64 points, with this one's; and what it gets
    # of the rest, as each of about as many points.
    most = _MOST * (1.0 + luminance(light) / (9 * 64 * RAYS))
    given = (luminance(light) - most) / (9 * 64)
    assert luminance(after[y, x]) == pytest.approx(RAYS + most + given, rel=0.01)
    np.testing.assert_allclose(after.sum(axis=(0, 1)), before.sum(axis=(0, 1)), rtol=0.005)
    # Beyond two tiles all is as it was, between it falls off without steps.
    np.testing.assert_array_equal(after[:, : x - 24], RAYS)
    row = luminance(after[y, x + 1 :])
    assert (np.diff(row) <= 1e-3).all()
    assert np.abs(np.diff(row)).max() < 0.2 * (row[0] - RAYS)


def test_where_it_comes_from_goes_with_it(found):
    after = found(sums_with("far", np.full(3, 5000.0)))
    flux = sum(after[:, :, 2 * k + 1, :3] for k in range(3)).sum(axis=(0, 1))
    assert flux[0] == pytest.approx(5000.0, rel=0.005)
    assert flux[1] == pytest.approx(RAYS * SIZE[0] * SIZE[1], rel=0.005)


def test_light_that_many_rays_find_stays_where_it_is(found):
    """However bright: a spot of lit points beside dark ones."""
    sums = sums_with("near", np.zeros(3))
    sums["near"][30:40, 30:40] = 100.0 * RAYS
    sums["brightest"][30:40, 30:40] = 200.0
    np.testing.assert_array_equal(whole(found(sums)), sums["near"])


def test_in_the_limit_of_many_samples_nothing_is_taken(found):
    sums = sums_with("near", np.full(3, 9000.0))
    np.testing.assert_array_equal(whole(found(sums, sample=10**6)), sums["near"])


@pytest.mark.slow
def test_a_light_close_to_the_ceiling_leaves_no_blots():
    """It makes a small place very bright, which one ray in some ten thousand finds."""
    paint = Material(base_color=(0.6, 0.6, 0.6), specular=0.0)
    room = Mesh(box(), paint, np.diag((6.0, 3.0, 6.0, 1.0)))
    light = PointLight((0.0, 1.49, -1.0), (1.0, 1.0, 1.0))
    # A plate below hides light and place from the eye, but for what is at its rim.
    plate = np.diag((1.2, 0.002, 1.2, 1.0))
    plate[:3, 3] = (0.0, 1.45, -1.0)
    eye = Camera((0.0, 0.0, 2.8), (0.0, 0.0, -3.0), fov_y_deg=60.0)
    scene = Scene((room, Mesh(box(), paint, plate)), (light,), camera=eye)
    layer = render(scene, "lpv", (256, 144), samples=4).layers["indirect"].mean(axis=-1)
    wall = layer[50:130, 60:196]
    smooth = np.median([np.roll(wall, s, a) for a in (0, 1) for s in range(-12, 13, 3)], axis=0)
    assert np.percentile(wall / smooth, 99.9) < 1.25
