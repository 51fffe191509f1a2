"""Air between cells: shares of two streams, on top of what walls close."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.gpu.memory import buffer_of
from airlight.lattice.placement import Placement
from airlight.maths.two_streams import ALONG_HOPS, columns, layer
from airlight.media.gpu_media import GpuMedia
from airlight.media.volume_blockers import VolumeBlockers
from airlight.scene import Scene, Volume

SIDE = 4
UNORM = 1.0 / 255.0


def faces(
    gpu: Gpu,
    owned: Callable[[Any], Any],
    volume: Volume,
    closed: float,
    boxes: Sequence[np.ndarray] = (),
) -> dict[str, np.ndarray]:
    """(z, y, x, 8, 4) shares of a lattice of 4^3 cells of half a metre around the origin, with all
    walls and with those in `boxes`."""
    scene = Scene(volumes=(volume,))
    air, commands = owned(GpuMedia(gpu, scene, light_count=0)), Commands(gpu)
    air.update(commands, scene, np.full(3, -1.0), np.full(3, 1.0))
    wall = np.zeros((SIDE**3, 8, 4), np.uint8)
    wall[:, :6, :3], wall[:, :6, 3] = round(100 * closed), round(255 * closed)
    wall[:, 6:] = 255 - round(255 * closed)
    walls = owned(buffer_of(gpu, "walls", wall))
    faced = owned(VolumeBlockers(gpu, air, SIDE**3))
    faced.encode(commands, Placement((-1.0,) * 3, 0.5, (SIDE,) * 3), walls, boxes)
    commands.submit()
    found = {"faces": faced.faces, "known": faced.known_faces}
    return {
        name: buffer.read().view(np.uint8).reshape(SIDE, SIDE, SIDE, 8, 4) * UNORM
        for name, buffer in found.items()
    }


@pytest.mark.parametrize("closed", [0.0, 0.4])
def test_what_collides_is_absorbed_or_goes_either_way(
    gpu: Gpu, owned: Callable[[Any], Any], closed: float
) -> None:
    sigma, albedo, g = 1.5, np.array([1.0, 0.8, 0.3]), 0.25
    air = Volume(
        (sigma,) * 3, shape="box", albedo=tuple(albedo), g=(g,) * 3, bounds=((-2,) * 3, (2,) * 3)
    )
    got = faces(gpu, owned, air, closed)["faces"]
    scattering = sigma * albedo * (1 - g)
    extinction = scattering + ALONG_HOPS * sigma * (1 - albedo)
    back, onwards = layer(0.5 * extinction.mean(), scattering / extinction.mean())
    through = onwards.mean()
    wall = round(255 * closed) * UNORM
    np.testing.assert_allclose(got[..., 6, :], (1 - wall) * through, atol=1.2 * UNORM)
    np.testing.assert_allclose(got[..., :6, 3], 1 - (1 - wall) * through, atol=1.2 * UNORM)
    reflected = round(100 * closed) * UNORM + (1 - wall) * back
    np.testing.assert_allclose(
        got[..., :6, :3], np.broadcast_to(reflected, (SIDE,) * 3 + (6, 3)), atol=1.2 * UNORM
    )


def test_white_air_keeps_all_light(gpu: Gpu, owned: Callable[[Any], Any]) -> None:
    ball = Volume((3.0,) * 3, shape="sphere", bounds=((-0.8,) * 3, (0.8,) * 3))
    got = faces(gpu, owned, ball, 0.0)["faces"]
    np.testing.assert_allclose(got[..., :6, 0], got[..., :6, 3], atol=1.2 * UNORM)
    assert got[..., :6, 3].max() > 0.2
    # Hop +x of a cell is closed as much as the next cell says of what comes in from it.
    np.testing.assert_allclose(1.0 - got[:, :, :-1, 0, 3], got[:, :, 1:, 6, 0], atol=1.2 * UNORM)
    assert got[0, 0, 0, 1, 3] == 0.0, "the ball does not reach into the corner"


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_light_passes_beside_what_fills_a_part_of_a_cell(
    gpu: Gpu, owned: Callable[[Any], Any], axis: int
) -> None:
    # Filled up to .2 m into the third cell, of which two of five rows of samples know.
    sigma, albedo, high = 6.0, 0.8, [2.0] * 3
    high[axis] = 0.2
    air = Volume((sigma,) * 3, shape="box", albedo=(albedo,) * 3, bounds=((-2,) * 3, tuple(high)))
    got = np.moveaxis(faces(gpu, owned, air, 0.0)["faces"], 2 - axis, 0)
    # Along the border: three fifths of the light pass.
    along_hops = sigma * (albedo + ALONG_HOPS * (1 - albedo))
    albedo *= sigma / along_hops
    reflected, through = columns([0.5 * along_hops] * 2 + [0.0] * 3, albedo)
    for along in ((axis + 1) % 3, (axis + 2) % 3):
        met = got[2, ..., 2 * along : 2 * along + 2, :]
        np.testing.assert_allclose(met[..., 3], 1 - through, atol=UNORM)
        np.testing.assert_allclose(met[..., 0], reflected, atol=UNORM)
    assert through > 0.6
    # Across it: from the middle of the second cell a layer as thick as there is of the medium.
    reflected, through = layer(0.45 * along_hops, albedo)
    np.testing.assert_allclose(got[1, ..., 2 * axis, 3], 1 - through, atol=UNORM)
    np.testing.assert_allclose(got[2, ..., 2 * axis + 1, 0], reflected, atol=UNORM)
    # Beyond the third cell's middle there is nothing.
    np.testing.assert_array_equal(got[2, ..., 2 * axis, :], 0.0)


def test_walls_beyond_the_boxes_of_known_ones_are_black(
    gpu: Gpu, owned: Callable[[Any], Any]
) -> None:
    air = Volume((1.5,) * 3, shape="box", bounds=((-2,) * 3, (2,) * 3))
    # The lower half along x is known.
    known = np.diag([1.0, 0.125, 0.125, 1.0])
    known[:3, 3] = (1.1, 0.5, 0.5)
    every, got = faces(gpu, owned, air, 0.4), faces(gpu, owned, air, 0.4, [known])
    np.testing.assert_array_equal(got["faces"], every["faces"])
    open_faces = faces(gpu, owned, air, 0.0)["faces"]
    black = every["known"]
    # What blocks is the same; what volumes reflect stays, of what walls leave open.
    np.testing.assert_array_equal(black[..., 3], every["faces"][..., 3])
    np.testing.assert_allclose(black[..., :6, :3], 0.6 * open_faces[..., :6, :3], atol=2.0 * UNORM)
    np.testing.assert_array_equal(got["known"][:, :, 0, :6], every["faces"][:, :, 0, :6])
    np.testing.assert_array_equal(got["known"][:, :, 3, :6], black[:, :, 3, :6])
