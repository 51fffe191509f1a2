"""Forward light is averaged over cells around, but never across a wall."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.fields import FORWARD_REACH
from airlight.gpu.memory import Texture, buffer_of
from airlight.scatter.forward_textures import Blur, BlurParams

COUNT, LIGHTS = (6, 8, 10), 2  # x, y, z
RNG = np.random.default_rng(5)


def mean_along(light, entering, axis):
    """Twin of scatter/forward_blur.wgsl. light (z, y, x), entering (z, y, x, 6); axis 0 is x."""
    own = 2 - axis
    light, entering = np.moveaxis(light, own, 0), np.moveaxis(entering, own, 0)
    made = np.zeros_like(light)
    for i in range(len(light)):
        total, weight = light[i].copy(), np.ones_like(light[i])
        for side, step in ((0, -1), (1, 1)):
            share, at = np.ones_like(weight), i
            for _ in range(FORWARD_REACH):
                if not 0 <= at + step < len(light):
                    break
                share = share * entering[at, ..., 2 * axis + side]
                at += step
                total += share * light[at]
                weight += share
        made[i] = total / weight
    return np.moveaxis(made, 0, own)


@pytest.fixture
def blur(gpu, commands, owned):
    """blur(light (lights, z, y, x), entering (z, y, x, 6) bytes, axis) -> light on the device."""

    def evaluate(light, entering, axis):
        x, y, z = COUNT
        size = (x, y, z * LIGHTS)
        made, target = (
            owned(Texture(gpu, "light", size, "rgba16float", dimension="3d", written=True))
            for _ in range(2)
        )
        texels = np.repeat(light.reshape(z * LIGHTS, y, x, 1), 4, axis=3)
        made.write(texels.astype(np.float16))
        packed = np.full((z, y, x, 8), 255, np.uint8)
        packed[..., :6] = entering
        Blur(gpu, generated=f"const REACH = {FORWARD_REACH}u;").dispatch(
            commands,
            size,
            params=BlurParams(count=COUNT, lights=LIGHTS, axis=axis, first_row=0, depth=COUNT[2]),
            face_visibility=owned(buffer_of(gpu, "faces", packed.view(np.uint32).reshape(-1, 2))),
            light=made,
            blurred=target,
        )
        commands.submit()
        return target.read()[..., 0].astype(np.float64).reshape(LIGHTS, z, y, x)

    return evaluate


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_device_averages_as_numpy_does(blur, axis):
    light = RNG.random((LIGHTS, *COUNT[::-1]))
    entering = RNG.choice([0, 60, 200, 255], (*COUNT[::-1], 6)).astype(np.uint8)
    found = blur(light, entering, axis)
    for one, made in zip(light, found, strict=True):
        # Shares below .01 end a walk on the device; half floats.
        np.testing.assert_allclose(made, mean_along(one, entering / 255.0, axis), atol=0.015)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_nothing_crosses_a_wall(blur, axis):
    own, middle = 2 - axis, COUNT[axis] // 2
    light = np.zeros((LIGHTS, *COUNT[::-1]))
    beyond = [slice(None)] * 4
    beyond[1 + own] = slice(middle, None)
    light[tuple(beyond)] = 1.0
    entering = np.full((*COUNT[::-1], 6), 255, np.uint8)
    for cell, hop in ((middle, 2 * axis), (middle - 1, 2 * axis + 1)):
        face = [slice(None)] * 3
        face[own] = cell
        entering[(*face, hop)] = 0
    np.testing.assert_array_equal(blur(light, entering, axis), light)
    entering[:] = 255
    assert not np.array_equal(blur(light, entering, axis), light)
