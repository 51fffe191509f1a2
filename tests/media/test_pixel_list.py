"""Pixels that a reduced image cannot tell are listed as the finishing pass goes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.gpu.memory import Buffer, Texture
from airlight.media.compositing.finish import Finish, Listing, MediaLayers, Reduced
from airlight.media.gpu_media import GpuMedia
from airlight.media.pixel_list import PixelList, RedrawParams
from airlight.media.rays import Rays
from airlight.scene import Camera, Medium, Mesh, Scene

SIZE = (38, 22)
GROUP = 64


def _numbers(gpu: Gpu, buffer: Buffer, count: int) -> Any:
    return np.frombuffer(gpu.queue.read_buffer(buffer.handle), np.uint32)[:count]


@pytest.mark.parametrize(("contrast", "edge"), [(0.0, 7), (0.5, 7), (0.5, 19)])
def test_those_between_unlike_texels_and_no_others(
    gpu: Gpu, look: Any, square: Callable[..., Mesh], contrast: float, edge: int
) -> None:
    wall = square((-50, -50, -3), (100, 0, 0), (0, 100, 0))
    camera = Camera((0.0, 0.0, 4.0), (0, 0, -1), fov_y_deg=10)
    medium = Medium((0.4, 0.9, 1.6), bounds=((-1.0, -0.8, -1.2), (1.0, 1.1, 1.3)))
    seen = look(Scene(meshes=(wall,), camera=camera, medium=medium), SIZE)
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    rays = Rays(gpu, SIZE, 2)
    rays.encode(seen.commands, seen.view)
    far = seen.read(rays.picked)[..., :1]
    sky, shaft = np.full((*far.shape[:2], 4), 0.25, np.float32), np.ones_like(far) * (1, 1, 1, 0)
    shaft = shaft.astype(np.float32)
    shaft[:, edge:, :3] = 3.0  # lit on one side
    sky[..., 3:] = shaft[..., 3:] = far

    def texture(values: Any) -> Texture:
        made = Texture(gpu, "reduced", rays.reduced, "rgba32float", written=True)
        made.write(values)
        return made

    full = {n: Texture(gpu, n, SIZE, "rgba32float", target=True, written=True) for n in "abcde"}
    listed = PixelList(gpu, SIZE)
    Finish(gpu, air, has_sky=True, lists=True).encode(
        seen.commands,
        rays,
        seen.view.gbuffer.depth,
        Reduced(texture(sky), texture(shaft), texture(sky)),
        MediaLayers((full["a"], full["b"]), full["c"], full["d"], full["e"]),
        Listing(listed, RedrawParams(contrast=contrast, group=GROUP)),
    )
    single = seen.read(full["e"])[..., 0]
    count = int(_numbers(gpu, listed.found, 1)[0])
    entries = _numbers(gpu, listed.chosen, 4 * count).reshape(-1, 4)
    places = {(int(n) & 0xFFFF, int(n) >> 16) for n in entries[:, 3]}
    # Texel `edge` - 1 and `edge` are both among the four of the pixels between their middles.
    between = range(2 * edge - 1, min(2 * edge + 1, SIZE[0]))
    columns = range(SIZE[0]) if contrast == 0.0 else between if edge < far.shape[1] else ()
    assert len(places) == count
    assert places == {(x, y) for x in columns for y in range(SIZE[1])}
    np.testing.assert_allclose(entries[:, :3].copy().view(np.float32), 0.25, rtol=1e-5)
    groups = _numbers(gpu, listed.groups, 3)
    assert tuple(groups) == (-(-count // GROUP), 1, 1)
    np.testing.assert_allclose(single[:, : 2 * edge - 2], 1.25, rtol=1e-5)
