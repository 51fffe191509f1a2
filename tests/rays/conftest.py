"""Sends rays on the device."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.compute import ComputePass
from airlight.gpu.device import Gpu
from airlight.gpu.memory import Buffer, buffer_of
from airlight.gpu.slots import storage
from airlight.rays.rays import RAY_SLOTS, RayScene
from airlight.scene import Scene
from airlight.surface.geometry import GpuScene

NO_HIT = 0xFFFFFFFF
_SLOTS = (
    storage("origins", "vec4f"),
    storage("directions", "vec4f"),
    storage("found", "vec4f", "read_write"),
    *RAY_SLOTS,
)
_KERNEL = """
//! use rays
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let o = origins[min(id.x, arrayLength(&origins) - 1u)];
    let d = directions[min(id.x, arrayLength(&origins) - 1u)];
    let hit = nearest_hit(o.xyz, d.xyz, o.w, d.w);
    let is_any = any_hit(o.xyz, d.xyz, o.w, d.w);
    if (id.x >= arrayLength(&origins)) { return; }
    let row = 5u * id.x;
    found[row] = vec4f(hit.t, bitcast<f32>(hit.triangle), bitcast<f32>(hit.instance), f32(is_any));
    found[row + 1u] = vec4f(hit.bary, 0.0, 0.0);
    if (hit.triangle != NO_HIT) {
        let at = hit_point(hit);
        found[row + 2u] = vec4f(at.position, bitcast<f32>(at.material));
        found[row + 3u] = vec4f(at.geometric_normal, at.uv.x);
        found[row + 4u] = vec4f(at.shading_normal, at.uv.y);
    }
}
"""


@dataclass
class Found:
    """What rays found, a row each; `corners` (N, 3, 3) of the triangle in its own space."""

    t: np.ndarray
    triangle: np.ndarray
    instance: np.ndarray
    is_any: np.ndarray
    bary: np.ndarray
    position: np.ndarray
    geometric_normal: np.ndarray
    shading_normal: np.ndarray
    uv: np.ndarray
    material: np.ndarray
    corners: np.ndarray

    @property
    def is_hit(self) -> np.ndarray:
        return self.triangle != NO_HIT


class Rays:
    """The rays of a scene; `send` them from origins along directions (N, 3)."""

    def __init__(self, gpu: Gpu, scene: Scene, kernel: ComputePass) -> None:
        self.gpu, self.commands, self.kernel = gpu.scope(), Commands(gpu), kernel
        self.meshes = GpuScene(self.gpu, scene)
        self.scene = RayScene(self.gpu, self.meshes)

    def move(self, scene: Scene) -> None:
        self.scene.update(self.commands, scene)

    def send(self, origin: Any, direction: Any, t_min: float = 0.0, t_max: float = 3e38) -> Found:
        count = len(direction)
        from_ = np.empty((count, 4), np.float32)
        from_[:, :3], from_[:, 3] = origin, t_min
        towards = np.empty((count, 4), np.float32)
        towards[:, :3], towards[:, 3] = direction, t_max
        scope = self.gpu.scope()
        given = [buffer_of(scope, "rays", data) for data in (from_, towards)]
        found = buffer_of(scope, "found", np.zeros((5 * count, 4), np.float32))
        self.kernel.dispatch(
            self.commands,
            (count, 1, 1),
            origins=given[0],
            directions=given[1],
            found=found,
            **self.scene.bound,
        )
        self.commands.submit()
        rows = found.read(np.float32).reshape(count, 5, 4).copy()
        scope.release()
        words = rows.view(np.uint32)
        triangles = _read(self.scene.triangles).reshape(-1, 16)
        is_hit = words[:, 0, 1] != NO_HIT
        corners = np.full((count, 3, 3), np.nan, np.float32)
        corners[is_hit] = triangles[words[is_hit, 0, 1], :9].reshape(-1, 3, 3)
        return Found(
            np.where(is_hit, rows[:, 0, 0], np.inf),
            words[:, 0, 1],
            words[:, 0, 2],
            rows[:, 0, 3] != 0.0,
            rows[:, 1, :2],
            rows[:, 2, :3],
            rows[:, 3, :3],
            rows[:, 4, :3],
            np.stack([rows[:, 3, 3], rows[:, 4, 3]], axis=1),
            words[:, 2, 3],
            corners,
        )


def _read(buffer: Buffer) -> np.ndarray:
    return np.asarray(buffer.read(np.float32))


@pytest.fixture
def rays(gpu: Gpu, kernel: Callable[..., ComputePass]) -> Any:
    """rays(scene) -> Rays."""
    made: list[Rays] = []
    tracing = kernel(_KERNEL, _SLOTS)

    def make(scene: Scene) -> Rays:
        made.append(Rays(gpu, scene, tracing))
        return made[-1]

    yield make
    for one in made:
        one.gpu.release()
