"""Light of later segments, shared by paths whose first segments met the same place."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from airlight.gather.later import SHARE, LaterLight
from airlight.gather.sums import PointSums
from airlight.gather.thinning import counts, rays_of
from airlight.gpu.memory import Texture, buffer_of
from airlight.rendering import Renderer
from airlight.scene import Camera, Material, Mesh, PointLight, Scene
from airlight.scene.shapes import box

SIZE, RAYS = (16, 12), 4
COUNT = SIZE[0] * SIZE[1]
LATER = rays_of(1, RAYS)
EYE = np.array([0.5, 1.0, -2.0])


def image_of(gpu, values):
    made = Texture(gpu, "values", values.shape[1::-1], "rgba32float")
    made.write(np.ascontiguousarray(values, dtype=np.float32))
    return made


@pytest.fixture
def met():
    """Rays from one place to points of the floor and of a wall, with what their paths found."""
    rng = np.random.default_rng(3)
    places = rng.uniform(0.0, 4.0, (RAYS, COUNT, 3))
    normals = np.zeros_like(places)
    is_floor = rng.uniform(size=(RAYS, COUNT)) < 0.5
    places[is_floor, 1], normals[is_floor, 1] = 0.0, 1.0
    places[~is_floor, 0], normals[~is_floor, 0] = 4.0, -1.0
    passed = rng.uniform(0.2, 0.8, places.shape)
    light = rng.gamma(0.2, 5.0, places.shape)
    # Paths that ended have no light of their own.
    light[LATER:] = 0.0
    return SimpleNamespace(places=places, normals=normals, passed=passed, light=light)


def sums_of(gpu, commands, met, start=(0.1, 3.0, 0.1)):
    """What points at `start` get of these paths, as `LaterLight` adds it: (COUNT, 3)."""
    size = (SIZE[0], SIZE[1] * RAYS)
    hits = [
        image_of(gpu, np.concatenate([v, np.ones_like(v[..., :1])], -1).reshape(*size[::-1], 4))
        for v in (met.places, met.normals)
    ]
    ones = np.ones((*SIZE[::-1], 1))
    starts = image_of(gpu, np.concatenate([np.broadcast_to(start, (*SIZE[::-1], 3)), ones], -1))
    normals = image_of(gpu, np.broadcast_to([0.0, -1.0, 0.0, 1.0], (*SIZE[::-1], 4)))
    points = SimpleNamespace(reduced=SIZE, count=COUNT, starts=starts, normals=normals)
    later = LaterLight(gpu, points, RAYS, RAYS)
    # A path's light went through what its first segment met, and counts for those that ended.
    passed = counts(0, RAYS) * met.passed
    rows = np.zeros((RAYS * COUNT, 2, 4), np.float32)
    rows[:, 0, :3] = (passed * met.light).reshape(-1, 3)
    later.passed.write(np.pad(passed.reshape(-1, 3), ((0, 0), (0, 1))).astype(np.float32))
    paths = SimpleNamespace(buffer=buffer_of(gpu, "paths", rows))
    sums = SimpleNamespace(
        buffer=buffer_of(gpu, "sums", np.zeros(COUNT, PointSums.dtype)),
        far=SimpleNamespace(buffer=buffer_of(gpu, "far", np.array([1e6], np.float32))),
    )
    view = SimpleNamespace(eye=tuple(EYE))
    hits = SimpleNamespace(positions=hits[0], normal=hits[1])
    later.begin(commands)
    later.encode(commands, view, paths, hits, range(RAYS), LATER, sums)
    commands.submit()
    found = sums.buffer.read(PointSums.dtype)
    return found["far"] + found["later"]


def means_of_cells(met):
    """The mean light of the paths in the cell of each ray: (RAYS, COUNT, 3); in how many."""
    size = 2.0 ** np.ceil(np.log2(SHARE * np.linalg.norm(met.places - EYE, axis=-1)))
    at = np.floor(met.places / size[..., None]).astype(int)
    side = np.abs(met.normals).argmax(-1)
    keys = np.concatenate([at, size[..., None] * 1e6, side[..., None]], -1).reshape(-1, 5)
    _, cell = np.unique(keys, axis=0, return_inverse=True)
    cell = cell.reshape(RAYS, COUNT)
    number = np.bincount(cell[:LATER].ravel(), minlength=cell.max() + 1)
    sums = np.stack(
        [
            np.bincount(cell[:LATER].ravel(), met.light[:LATER, :, k].ravel(), cell.max() + 1)
            for k in range(3)
        ],
        -1,
    )
    return (sums / np.maximum(number, 1)[:, None])[cell], number[cell]


def test_a_ray_takes_the_mean_of_the_paths_that_met_its_cell(gpu, commands, met):
    means, number = means_of_cells(met)
    # A cell whose only path is the ray's own tells nothing more.
    is_own = np.arange(RAYS)[:, None] < LATER
    is_known = number >= 1 + is_own
    own = counts(0, RAYS) * met.light
    expected = met.passed * np.where(is_known[..., None], means, own)
    assert is_known.mean() > 0.5
    np.testing.assert_allclose(
        sums_of(gpu, commands, met), expected.sum(axis=0), rtol=1e-4, atol=1e-5
    )


def test_sums_do_not_depend_on_the_order_of_paths(gpu, commands, met):
    """Whatever threads come first, to the bit: an image is the same each time it is drawn."""
    turned = SimpleNamespace(**{k: v[:, ::-1] for k, v in vars(met).items()})
    np.testing.assert_array_equal(sums_of(gpu, commands, met), sums_of(gpu, commands, turned)[::-1])


def test_short_rays_take_their_own_light(gpu, commands, met):
    """What is nearer than a quarter of a cell may be dark where the cell as a whole is not."""
    start = np.array([1.0, 1e-3, 1.0])
    met.places[:], met.normals[:] = start * (1.0, 0.0, 1.0), (0.0, 1.0, 0.0)
    expected = counts(0, RAYS) * (met.passed * met.light).sum(axis=0)
    np.testing.assert_allclose(sums_of(gpu, commands, met, start), expected, rtol=1e-5)


def test_what_is_not_reflected_is_not_known(gpu, commands, met):
    """Black surfaces tell nothing of the light that came to them, and bring none."""
    met.passed[...] = 0.0
    assert not sums_of(gpu, commands, met).any()


def test_light_of_another_scene_is_forgotten():
    """An image is the same to the bit after a renderer has drawn the room in other light."""
    settings = {"resolution": 8, "lamp_resolution": 128, "map_resolution": 64, "iterations": 8}
    room = Mesh(box(), Material(base_color=(0.7,) * 3), np.diag((4.0, 4.0, 4.0, 1.0)))
    eye = Camera((0.0, 0.0, 1.9), (0.0, -0.5, -2.0), fov_y_deg=60.0)
    dim, bright = (
        Scene((room,), (PointLight((0.0, 1.0, 0.0), (power,) * 3),), camera=eye)
        for power in (10.0, 40.0)
    )
    with Renderer(dim, "lpv", (32, 24), settings=settings) as renderer:
        images = []
        for scene in (dim, bright, dim):
            renderer.show(scene)
            images.append(renderer.frame(samples=2).layers["indirect"])
    np.testing.assert_array_equal(images[2], images[0])
    np.testing.assert_allclose(images[1], 4.0 * images[0], rtol=2e-3)
