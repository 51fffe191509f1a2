"""The final gather against quadrature, closed forms and the field that it replaces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.gather.points import MOST_POINTS, reduction
from airlight.gather.solver import GatherSolver
from airlight.gpu.pipelines import Pipelines
from airlight.lighting.view import View
from airlight.rendering import Renderer, render
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    PointLight,
    Scene,
    Texture,
)
from airlight.scene.point_lights import PointLights
from airlight.scene.shapes import box
from airlight.techniques.technique import Technique

from .panels import LPV, PAINT, X, Y, Z, rectangle

SIZE = (48, 32)
ABOVE = Camera((0.0, 3.0, 0.8), (0.0, 0.0, 0.8), (0.0, 0.0, -1.0), 30.0)
FLOOR = rectangle(-3 * X - 3 * Z, 6 * X, 6 * Z)
WALL = rectangle(-1 * X, 2 * X, 2 * Y)


def test_a_floor_before_a_lit_wall_gathers_what_quadrature_says():
    """The wall sends rho/pi of what the light gives it, nothing else is lit."""
    scene = Scene((FLOOR, WALL), (DirectionalLight((0, 0, -1), (2, 2, 2)),), camera=ABOVE)
    settings = {**LPV, "gather": "still", "gather_rays": 16, "bounces": False}
    image = render(scene, "lpv", SIZE, samples=32, settings=settings)
    x, y = ((np.arange(60) + 0.5) / 60 * 2.0 for _ in range(2))
    wall = np.stack(np.meshgrid(x - 1.0, y, 0.0, indexing="ij"), -1).reshape(-1, 3)
    # Each pixel's point on the floor: the camera looks straight down.
    v, u = np.mgrid[: SIZE[1], : SIZE[0]]
    half = 3.0 * np.tan(np.radians(15.0))
    points = np.stack(
        [
            ((u + 0.5) / SIZE[0] * 2.0 - 1.0) * half * SIZE[0] / SIZE[1],
            np.zeros(u.shape),
            0.8 + ((v + 0.5) / SIZE[1] * 2.0 - 1.0) * half,
        ],
        -1,
    )
    path = wall[:, None] - points.reshape(-1, 3)
    squared = (path**2).sum(-1)
    kernel = np.maximum(path[..., 1], 0.0) * np.abs(path[..., 2]) / squared**2
    irradiance = (kernel.sum(0) * (2.0 / 60) ** 2).reshape(u.shape)
    rho = np.array(PAINT.base_color)
    truth = irradiance[..., None] * 2.0 * rho / np.pi * rho / np.pi
    is_before = points[..., 2] > 0.15
    found = image.layers["indirect"][is_before]
    truth = truth[is_before]
    # 512 rays of which a third meets the wall: .06 a pixel, less what neighbours share. The three
    # passes of the filter blur an image as small as this one: .066 (two passes: below .04).
    assert np.linalg.norm(found - truth) / np.linalg.norm(truth) < 0.075
    assert found.sum() / truth.sum() == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("reflectance", [0.3, 0.8])
def test_a_closed_room_stays_a_furnace(reflectance):
    """The indirect light's mean radiance is what the walls' first irradiance adds up to."""
    paint = Material(base_color=(reflectance,) * 3, specular=0.0)
    room = Mesh(box(), paint, np.diag((4.0, 4.0, 4.0, 1.0)))
    scene = Scene((room,), (PointLight((0, 0, 0), (10, 10, 10)),))
    settings = {
        **LPV,
        "resolution": 16,
        "lamp_resolution": 128,
        "map_resolution": 128,
        "iterations": 128,
    }
    first = 4.0 * np.pi * 10.0 / 96.0
    with Renderer(scene, "lpv", SIZE, settings={**settings, "gather": "always"}) as renderer:
        looks = [(1, 0, 0), (0, 0, 1), (0, -1, 0)]
        frames = [renderer.frame(camera=Camera((0, 0, 0), t, fov_y_deg=90.0)) for t in looks]
    indirect = np.mean([frame.layers["indirect"] for frame in frames])
    truth = first * reflectance / (1.0 - reflectance) * reflectance / np.pi
    assert indirect == pytest.approx(truth, rel=0.03)


def test_light_is_even_along_the_seam_of_walls():
    """Rays are short there, but walls look alike from all along it."""
    room = Mesh(box(), PAINT, np.diag((4.0, 4.0, 4.0, 1.0)))
    light = PointLight((1.5, 0.0, 1.5), (10, 10, 10))
    eye = Camera((0.0, 0.0, 0.0), (-1.0, 0.0, -1.2), fov_y_deg=50.0)
    image = render(Scene((room,), (light,), camera=eye), "lpv", (96, 64), samples=4, settings=LPV)
    indirect = image.layers["indirect"].mean(axis=-1)
    beside = np.abs(np.diff(image.layers["normal"][32, :, 0])).argmax() + np.array([0, 1])
    seam = indirect[:, beside]
    jumps = np.abs(np.diff(seam, n=2, axis=0)) / seam[1:-1]
    # .24 where points shared by the harmonic mean of distances alone, now .04.
    assert np.sqrt((jumps**2).mean()) < 0.08


def test_an_open_floor_sees_all_of_a_uniform_sky():
    scene = Scene((FLOOR,), environment=Environment((1.0, 2.0, 3.0)), camera=ABOVE)
    image = render(scene, "lpv", SIZE, samples=2, settings={**LPV, "gather": "still"})
    truth = np.array(PAINT.base_color) * (1.0, 2.0, 3.0)
    np.testing.assert_allclose(
        image.layers["direct"], np.broadcast_to(truth, (*SIZE[::-1], 3)), rtol=2e-3
    )


@pytest.mark.parametrize("visible", [True, False])
def test_a_small_bright_part_of_the_sky_is_not_found_by_luck(visible):
    """One texel of 64 x 32 sends more than all others together, seen or not."""
    map = np.full((32, 64, 3), 0.1, np.float32)
    map[8, 20] = 500.0
    sky = Environment(map=map, rotation_deg=33.0, visible=visible)
    scene = Scene((FLOOR,), environment=sky, camera=ABOVE)
    image = render(scene, "lpv", SIZE, samples=2, settings={**LPV, "gather": "still"})
    edges = np.linspace(0.0, np.pi, 33)
    # Of a band between two polar angles, the integral of the cosine over the sphere's upper half.
    bands = np.pi * np.diff(np.sin(np.minimum(edges, np.pi / 2)) ** 2)
    irradiance = 0.1 * bands.sum() + 499.9 * bands[8] / 64
    truth = irradiance * np.array(PAINT.base_color) / np.pi
    found = image.layers["direct"]
    np.testing.assert_allclose(found.mean(axis=(0, 1)), truth, rtol=0.02)
    assert found.max() < 1.6 * truth.max()


def test_the_mean_of_samples_converges(cornell):
    settings = {**LPV, "gather": "still", "gather_rays": 2}
    few, more, many = (
        render(cornell, "lpv", SIZE, samples=n, settings=settings).layers["indirect"]
        for n in (2, 16, 48)
    )
    assert np.linalg.norm(more - many) < 0.6 * np.linalg.norm(few - many)


def test_stills_gather_and_moving_frames_do_not(cornell):
    def frame(gather, samples=1):
        with Renderer(cornell, "lpv", SIZE, settings={**LPV, "gather": gather}) as renderer:
            image = renderer.frame(samples=samples)
            assert image is not None
            return image.layers["indirect"]

    off, still, always = (frame(gather) for gather in ("off", "still", "always"))
    np.testing.assert_array_equal(off, still)
    assert np.linalg.norm(always - off) > 0.05 * np.linalg.norm(off)
    assert np.linalg.norm(frame("still", 2) - frame("off", 2)) > 0.05 * np.linalg.norm(off)


def test_lights_by_the_thousand_and_the_papers_scheme_keep_the_lattice(cornell):
    group = PointLights(np.array([[0.0, 0.0, 0.5]]), np.ones((1, 3)))
    scene = replace(cornell, light_groups=(group,))
    for shown, more in ((scene, {}), (cornell, {"scheme": "paper"})):
        images = [
            render(shown, "lpv", SIZE, samples=2, settings={**LPV, **more, "gather": gather})
            for gather in ("off", "still")
        ]
        np.testing.assert_array_equal(images[0].radiance, images[1].radiance)


def test_many_rays_come_in_batches_and_views_change_their_size(cornell, monkeypatch):
    settings = {**LPV, "gather": "always", "gather_rays": 5}
    with Renderer(cornell, "lpv", SIZE, settings=settings) as renderer:
        whole = renderer.frame()
    monkeypatch.setattr("airlight.gather.batches.MOST_HITS", 2 * SIZE[0] * SIZE[1])
    with Renderer(cornell, "lpv", (30, 20), settings=settings) as renderer:
        renderer.frame()
        renderer.resize(SIZE)
        parts = renderer.frame()
    assert whole is not None and parts is not None
    np.testing.assert_allclose(parts.radiance, whole.radiance, rtol=1e-5, atol=1e-6)


def test_blocks_grow_with_the_image():
    assert reduction((96, 54), MOST_POINTS) == 1
    assert reduction((640, 360), MOST_POINTS) == 3
    assert reduction((1280, 720), MOST_POINTS) == 6


def test_rays_meet_what_began_to_move():
    """A wall that leaves the floor's side between frames, beside one that always stood there."""
    sun = (DirectionalLight((0, 0, -1), (2, 2, 2)),)
    away = np.eye(4)
    away[:3, 3] = (0.0, 0.0, 0.5)
    before, after = (FLOOR, WALL), (FLOOR, replace(WALL, world_from_object=away))
    settings = {**LPV, "gather": "always", "bounces": False}
    with Renderer(Scene(before, sun, camera=ABOVE), "lpv", SIZE, settings=settings) as renderer:
        renderer.frame()
        followed = renderer.frame(meshes=after)
    with Renderer(Scene(after, sun, camera=ABOVE), "lpv", SIZE, settings=settings) as renderer:
        fresh = renderer.frame()
    assert followed is not None and fresh is not None
    a, b = (frame.layers["indirect"] for frame in (followed, fresh))
    assert np.linalg.norm(a - b) < 0.02 * np.linalg.norm(b)


def test_a_scene_and_a_lattice_of_another_size_compile_nothing_again(monkeypatch):
    """Sizes are read from buffers: one that a shader has as a constant is a pipeline for each."""
    made, get = [], Pipelines.get
    monkeypatch.setattr(
        Pipelines,
        "get",
        lambda self, text, parts, make: get(
            self, text, parts, lambda: made.append(parts[0]) or make()
        ),
    )
    lights = (PointLight((0.5, 1.5, 1.0), (5, 5, 5)),)
    for size, cells in ((1.0, 8), (1.37, 12)):
        made.clear()
        large = np.diag((size, size, size, 1.0))
        meshes = tuple(replace(mesh, world_from_object=large) for mesh in (FLOOR, WALL))
        settings = {**LPV, "resolution": cells, "gather": "still"}
        render(Scene(meshes, lights, camera=ABOVE), "lpv", (24, 16), samples=2, settings=settings)
    assert not made


def bumpy_floor():
    """A floor whose relief turns the normal at random, every ten centimetres."""
    turn = np.random.default_rng(5).uniform(-0.8, 0.8, (60, 60, 2))
    n = np.concatenate([turn, np.ones((60, 60, 1))], -1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    pixels = np.concatenate([np.round(127.5 + 127.5 * n), np.full((60, 60, 1), 255.0)], -1)
    relief = Texture(pixels.astype(np.uint8), is_srgb=False)
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
    flat = replace(FLOOR.geometry, uvs=uvs)
    return Mesh(flat, replace(PAINT, normal_texture=relief))


def test_blocks_of_pixels_keep_their_relief(monkeypatch):
    """Points for blocks of 6 x 6 pixels, beside one for each pixel: a floor before a lit wall."""
    scene = Scene((bumpy_floor(), WALL), (DirectionalLight((0, 0, -1), (2, 2, 2)),), camera=ABOVE)
    settings = {**LPV, "gather": "still", "gather_rays": 32, "glossy_rays": False}

    def indirect(samples):
        image = render(scene, "lpv", (96, 66), samples=samples, settings=settings)
        return image.layers["indirect"][36:]

    fine = indirect(16)
    monkeypatch.setattr("airlight.gather.points.MOST_POINTS", 16 * 11)
    coarse = indirect(16)
    blocks = fine.reshape(5, 6, 16, 6, 3)
    means = np.broadcast_to(blocks.mean(axis=(1, 3), keepdims=True), blocks.shape)
    off = [np.linalg.norm(found - fine) for found in (coarse, means.reshape(fine.shape))]
    # A third of what one value for each block would be off: .361. Beams, as here, follow a normal
    # by a little less than they do, so that even light does not by too much (without it .34).
    assert off[0] < 0.38 * off[1]
    # Passes reach over all of 16 x 11 points, and blur the bright strip before the wall. Beside the
    # mean of 400 samples they had .909 of the light (now .92), points of pixels .964.
    assert coarse.sum() == pytest.approx(fine.sum(), rel=0.06)


@pytest.fixture
def cornell():
    """The Cornell box, without the lamp's own softness."""
    from airlight.scene.io import load

    return load("builtin:cornell")


def test_images_of_a_sample_share_what_it_gathered(cornell, monkeypatch):
    counted = {"draws": 0, "gathers": 0}
    draw, gather = Technique.draw, GatherSolver._gathered

    def drawn(self, *args):
        counted["draws"] += 1
        return draw(self, *args)

    def gathered(self, *args):
        counted["gathers"] += 1
        return gather(self, *args)

    monkeypatch.setattr(Technique, "draw", drawn)
    monkeypatch.setattr(GatherSolver, "_gathered", gathered)
    render(cornell, "lpv", SIZE, samples=3, settings=LPV)
    assert counted == {"draws": 3 * 3, "gathers": 3}


def test_images_of_a_sample_look_through_one_point_of_the_lens(cornell, monkeypatch):
    aims = []
    aim = View.aim

    def aimed(self, camera, *args):
        aims.append((camera.position, *args))
        aim(self, camera, *args)

    monkeypatch.setattr(View, "aim", aimed)
    camera = replace(cornell.camera, aperture_m=0.05)
    render(replace(cornell, camera=camera), "lpv", SIZE, samples=3, settings=LPV)
    assert len(aims) == 3 * 3
    eyes = [{eye for eye, _, sample, _ in aims if sample == k} for k in range(3)]
    assert all(len(found) == 1 for found in eyes)
    assert len(set.union(*eyes)) == 3
    # Less than a pixel apart, and none on another.
    for k in range(3):
        jitters = np.array([jitter for _, jitter, sample, _ in aims if sample == k])
        apart = np.abs(np.diff(jitters, axis=0))
        assert apart.max() < 1.0
        assert apart.max(axis=1).min() > 0.0


def test_edges_of_a_gathered_still_are_those_of_more_samples():
    """A board aslant over the floor that it shadows: silhouette and shadow cross pixels."""
    board = rectangle(-X + 0.2 * Y, 2 * X + 0.7 * Z, Y + 0.3 * X)
    light = PointLight((0.5, 2.5, 2.0), (20.0, 20.0, 20.0))
    aside = Camera((2.0, 1.7, 3.0), (0.0, 0.5, 0.0), (0.0, 1.0, 0.0), 45.0)
    scene = Scene((FLOOR, board), (light,), camera=aside)
    stills = {
        (gather, samples): render(
            scene, "lpv", SIZE, samples=samples, settings={**LPV, "gather": gather}
        ).layers["direct"]
        for gather, samples in (("off", 4), ("still", 4), ("off", 128))
    }
    truth = stills["off", 128]
    off = [np.linalg.norm(stills[gather, 4] - truth) for gather in ("off", "still")]
    assert off[1] < 0.75 * off[0]
