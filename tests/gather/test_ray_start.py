"""Where rays of a pixel's surface start: the shader's formula beside NumPy's."""

from __future__ import annotations

import numpy as np

from airlight.gather.points import pixel_m
from airlight.gpu.layout import Struct, mat4x4f, vec2f, vec3f
from airlight.gpu.memory import buffer_of
from airlight.gpu.slots import storage, uniform
from airlight.maths.transforms import clip_from_view_infinite, view_from_world

MAIN = """
//! use ray_start
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= arrayLength(&points)) { return; }
    let width = pixel_width(params.world_from_clip, params.size.y);
    let start = ray_start(points[id.x].xyz, normals[id.x].xyz, params.eye, width);
    results[id.x] = vec4f(start, width);
}
"""


class Params(Struct):
    """A camera."""

    world_from_clip = mat4x4f()
    eye = vec3f("m")
    size = vec2f("px")


def test_rays_start_above_the_surface_and_nearer_to_the_eye(gpu, commands, kernel, owned):
    rng = np.random.default_rng(3)
    eye, size = np.array([1.0, 2.0, -3.0]), (320, 180)
    rows = rng.uniform(-1.0, 1.0, (2, 50, 4)).astype(np.float32)
    p, n = 10.0 * rows[0, :, :3].astype(np.float64), rows[1, :, :3].astype(np.float64)
    rows[0, :, :3] = p
    clip = clip_from_view_infinite(0.9, 16 / 9, 1e-5) @ view_from_world(eye, (1, -1, 2), (0, 1, 0))
    world_from_clip = np.linalg.inv(clip)
    results = owned(buffer_of(gpu, "results", np.zeros_like(rows[0])))
    slots = (
        uniform("params", Params),
        *(storage(name, "vec4f") for name in ("points", "normals")),
        storage("results", "vec4f", "read_write"),
    )
    kernel(MAIN, slots).dispatch(
        commands,
        (50,),
        params=Params(world_from_clip=world_from_clip, eye=eye, size=size),
        points=owned(buffer_of(gpu, "points", rows[0])),
        normals=owned(buffer_of(gpu, "normals", rows[1])),
        results=results,
    )
    commands.submit()
    found = results.read().reshape(-1, 4)
    # A thirty-second of a pixel's width, and 2e-4 of the distance both ways.
    width, away = pixel_m(world_from_clip, size[1]), eye - p
    distance = np.linalg.norm(away, axis=1, keepdims=True)
    moved = (2e-4 + width / 32.0) * away + 2e-4 * distance * n
    np.testing.assert_allclose(found[:, 3], width, rtol=1e-4)
    np.testing.assert_allclose(found[:, :3] - p, moved, atol=3e-6)
