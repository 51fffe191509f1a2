"""Blur of a lens and of a shutter, against its size in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.maths.sampling import lens_points, shutter_shares
from airlight.rendering import Renderer, render
from airlight.scene import Camera, Material, Mesh, Scene
from airlight.scene.animation import Animation, Curve
from airlight.scene.animation.tracks import MeshTrack, Placing
from airlight.scene.lens import through_lens
from airlight.scene.shapes import sphere

SIZE = (120, 80)
SMALL = {"shadow_resolution": 16, "lamp_resolution": 16, "area_samples": 1, "surfels": 100}
"""All light here is a black ball's own: nothing is lit by it, and shadow maps are of no use."""


def glowing(at, radius_m: float) -> Mesh:
    matrix = np.diag((2.0 * radius_m,) * 3 + (1.0,))
    matrix[:3, 3] = at
    return Mesh(
        geometry=sphere(24, 12),
        world_from_object=matrix,
        material=Material(base_color=(0.0,) * 3, emission=(50.0,) * 3),
    )


def spread(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean place and variance (x, y), pixels, of an image's light."""
    light = image.sum(axis=2)
    y, x = np.mgrid[: light.shape[0], : light.shape[1]]
    mean = np.array([(light * x).sum(), (light * y).sum()]) / light.sum()
    square = np.array([(light * x**2).sum(), (light * y**2).sum()]) / light.sum()
    return mean, square - mean**2


@pytest.mark.parametrize("distance_m", [2.0, 4.0, 12.0])
def test_the_circle_of_confusion_is_a_thin_lens_s(gpu, distance_m):
    """A small ball on the axis, in focus at 4 m: its light spreads over a disc of the diameter
    aperture |d - f| / d in the plane of focus, whose variance along an axis is diameter^2 / 16."""
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y_deg=40.0, aperture_m=0.4, focus_m=4.0)
    scene = Scene(meshes=(glowing((0.0, 0.0, -distance_m), 0.04 * distance_m),), camera=camera)
    pinhole = replace(scene, camera=replace(camera, aperture_m=0.0))
    sharp_at, sharp = spread(render(pinhole, "direct", SIZE, settings=SMALL, samples=64).radiance)
    at, blurred = spread(render(scene, "direct", SIZE, settings=SMALL, samples=64).radiance)
    px_per_m = SIZE[1] / (2.0 * 4.0 * np.tan(np.radians(20.0)))
    diameter = 0.4 * abs(distance_m - 4.0) / distance_m * px_per_m
    # 64 points of the sequence have the disc's variance within 5 %, and go with the pixel's points
    # by a correlation of .09.
    near = 0.05 * diameter**2 / 16.0 + 2.0 * 0.09 * diameter / 4.0 * 12.0**-0.5 + 0.03
    assert blurred - sharp == pytest.approx(np.full(2, diameter**2 / 16.0), abs=near)
    assert at == pytest.approx(sharp_at, abs=0.15)


def test_without_a_lens_nothing_changes():
    camera = Camera()
    assert through_lens(camera, (0.25, -0.25), 3, 80) == (camera, (0.25, -0.25))


def test_in_focus_by_default_is_the_target():
    camera = Camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), aperture_m=0.2)
    asked = through_lens(replace(camera, focus_m=5.0), (0.0, 0.0), 5, 80)
    assert through_lens(camera, (0.0, 0.0), 5, 80)[1] == asked[1]
    near = through_lens(replace(camera, focus_m=2.0), (0.0, 0.0), 5, 80)
    assert np.allclose(near[1], 2.5 * np.array(asked[1]))


def test_points_fill_the_lens_and_times_the_shutter():
    points = np.array([lens_points(k) for k in range(64)])
    assert np.linalg.norm(points, axis=1).max() <= 1.0
    assert points.mean(axis=0) == pytest.approx((0.0, 0.0), abs=0.03)
    assert (points**2).mean(axis=0) == pytest.approx((0.25, 0.25), rel=0.05)
    assert np.allclose(np.sort(shutter_shares(16)), (np.arange(16) + 0.5) / 16)


def moving(shutter_s: float) -> Scene:
    """A ball that goes 1 m to the right in each second."""
    curve = Curve(np.array([0.0, 4.0]), np.array([[-1.0, 0.0, 0.0], [3.0, 0.0, 0.0]]), "linear")
    ball = glowing((0.0, 0.0, 0.0), 0.15)
    track = MeshTrack(0, ball.world_from_object[None], Placing({"translate": curve}, {}))
    camera = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), fov_y_deg=40.0, shutter_s=shutter_s)
    return Scene(meshes=(ball,), camera=camera, animation=Animation((track,)))


def test_what_moves_is_smeared_along_its_way(gpu):
    """From x = -.5 to .5 m: the mean in the middle, the variance that of an even line."""
    px_per_m = SIZE[1] / (2.0 * 4.0 * np.tan(np.radians(20.0)))
    image = render(moving(1.0), "direct", SIZE, settings=SMALL, samples=32, time=0.5).radiance
    still = render(moving(0.0), "direct", SIZE, settings=SMALL, samples=32, time=0.5).radiance
    at, variance = spread(image)
    began, sharp = spread(still)
    assert at[0] - began[0] == pytest.approx(0.5 * px_per_m, abs=0.2)
    assert variance[0] - sharp[0] == pytest.approx(px_per_m**2 / 12.0, rel=0.02)
    assert variance[1] == pytest.approx(sharp[1], abs=0.1)
    assert image.sum() == pytest.approx(still.sum(), rel=0.02)


def test_a_frame_leaves_the_scene_at_its_time(gpu):
    """The frame after one with an open shutter is the same as without it."""
    with Renderer(moving(1.0), "direct", SIZE, settings=SMALL) as renderer:
        renderer.frame(time=0.5, samples=4)
        after = renderer.frame().radiance
    with Renderer(moving(1.0), "direct", SIZE, settings=SMALL) as renderer:
        alone = renderer.frame(time=0.5).radiance
    assert np.array_equal(after, alone)


def test_an_open_shutter_needs_no_time(gpu, monkeypatch):
    """From the animation's start on, and of many samples; a still scene has those of a still."""
    image = render(moving(1.0), "direct", SIZE, settings=SMALL, samples=8).radiance
    assert np.array_equal(
        image, render(moving(1.0), "direct", SIZE, settings=SMALL, samples=8, time=0.0).radiance
    )
    seen = []
    whole = Renderer.frame
    monkeypatch.setattr(
        Renderer, "frame", lambda self, **kw: seen.append(kw["samples"]) or whole(self, **kw)
    )
    render(moving(1.0), "direct", (16, 16), settings=SMALL)
    render(replace(moving(1.0), animation=None), "direct", (16, 16), settings=SMALL)
    assert seen == [64, 12]


def test_a_frame_solves_once_for_each_moment(gpu, monkeypatch):
    with Renderer(moving(1.0), "direct", SIZE, settings=SMALL) as renderer:
        times, whole = [], renderer.technique.solve
        monkeypatch.setattr(
            renderer.technique, "solve", lambda *a, **kw: times.append(a[1]) or whole(*a, **kw)
        )
        renderer.frame(time=0.5, samples=4)
    assert len(times) == 4
