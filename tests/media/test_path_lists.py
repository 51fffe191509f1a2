"""Lists of the media between a block of space and a light hold whatever a path there meets."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.media.gpu_media import GpuMedia
from airlight.media.media_tree import media_nodes
from airlight.scene import DirectionalLight, PointLight, Scene
from airlight.scene.volume import Volume

LIGHTS = (
    DirectionalLight((0.5, -1, -0.4), (1, 1, 1)),
    DirectionalLight((0, 0, 1), (1, 1, 1)),
    PointLight((0.3, 0.2, -0.1), (1, 1, 1)),
    PointLight((9, 7, -8), (1, 1, 1)),
)


def boxes(count: int, rng: np.random.Generator) -> tuple[Volume, ...]:
    """Turned and stretched, a few of them apart and many over one another."""
    made = []
    for _ in range(count):
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        to_world = np.eye(4)
        to_world[:3, :3] = turn * rng.uniform(0.2, 0.6, 3)
        to_world[:3, 3] = rng.uniform((-3, -1, -2), (3, 1, 2))
        made.append(Volume((1, 1, 1), shape="box", world_from_volume=to_world))
    return tuple(made)


def world_box(media: GpuMedia) -> tuple[np.ndarray, np.ndarray]:
    """The box of all media, the root of their tree."""
    root = media_nodes(media.rows, media.count)[0]
    return root[0, :3], root[1, :3]


def met(media: GpuMedia, points: np.ndarray, toward: np.ndarray, reach: float) -> np.ndarray:
    """(points, media): whether the path from each point to a light goes through each box."""
    to_box = np.array([row["volume_from_world"] for row in media.rows])
    o = np.einsum("mij,pj->pmi", to_box[:, :3, :3], points) + to_box[:, :3, 3]
    d = np.einsum("mij,pj->pmi", to_box[:, :3, :3], toward)
    a, b = -o / d, (1 - o) / d
    near = np.maximum(np.minimum(a, b).max(axis=-1), 0.0)
    return near <= np.minimum(np.maximum(a, b).min(axis=-1), reach)


def listed(media: GpuMedia, points: np.ndarray, light: int) -> np.ndarray:
    """(points, media): whether the list of each point's block has each medium."""
    assert media.paths is not None
    nx, ny, nz = media.paths.count
    low, high = world_box(media)
    block = np.clip(
        ((points - low) / (high - low) * (nx, ny, nz)).astype(int), 0, (nx - 1, ny - 1, nz - 1)
    )
    texels = -(-media.count // 128)
    words = media.paths.texture.read()[light * texels : (light + 1) * texels]
    bits = words[:, block[:, 2], block[:, 1] * nx + block[:, 0]]
    found = (bits[..., None] >> np.arange(32, dtype=np.uint32)) & 1
    return np.moveaxis(found, 1, 0).reshape(len(points), -1)[:, : media.count] > 0


@pytest.mark.parametrize("count", [20, 150])
def test_lists_hold_what_paths_meet_and_little_else(gpu: Gpu, count: int) -> None:
    """150 media take two texels a list."""
    rng = np.random.default_rng(4)
    scene = Scene(volumes=boxes(count, rng), lights=LIGHTS)
    media, commands = GpuMedia(gpu, scene, light_count=len(LIGHTS)), Commands(gpu)
    media.update(commands, scene, *scene.bounds)
    commands.submit()
    points = rng.uniform(*world_box(media), (4000, 3))
    for i, light in enumerate(LIGHTS):
        is_local = isinstance(light, PointLight)
        toward = (
            light.position - points if is_local else np.tile(-np.array(light.direction), (4000, 1))
        )
        true = met(media, points, toward, 1.0 if is_local else np.inf)
        found = listed(media, points, i)
        assert not (true & ~found).any()
        # From a block of side b a medium of side s counts as one of s + b, more where it is turned:
        # here both are .4 m, which makes four times what single points meet. Measured: 5 at most.
        assert found.sum() < 6 * true.sum()


def test_moved_media_are_listed_where_they_are(gpu: Gpu) -> None:
    """The lists of moved media are those of media that were made there."""
    rng = np.random.default_rng(5)
    before, after = (Scene(volumes=boxes(12, rng), lights=LIGHTS) for _ in range(2))
    media, commands = GpuMedia(gpu, before, light_count=len(LIGHTS)), Commands(gpu)
    fresh = GpuMedia(gpu, before, light_count=len(LIGHTS))
    media.update(commands, before, *before.bounds)
    media.update(commands, after, *after.bounds)
    fresh.update(commands, after, *after.bounds)
    commands.submit()
    assert media.paths is not None
    assert fresh.paths is not None
    np.testing.assert_array_equal(media.paths.texture.read(), fresh.paths.texture.read())
    lights = (LIGHTS[1], *LIGHTS[1:])
    media.update(commands, Scene(volumes=after.volumes, lights=lights), *after.bounds)
    commands.submit()
    assert (media.paths.texture.read() != fresh.paths.texture.read()).any()
