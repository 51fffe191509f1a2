"""Sends rays on the device."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.compute import ComputePass
from airlight.gpu.device import Gpu
from airlight.gpu.memory import buffer_of
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
//! use ray_surface
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
    """What rays found, a row each."""

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

    @property
    def is_hit(self) -> np.ndarray:
        return self.triangle != NO_HIT


class Rays:
    """The rays of a scene; `send` them from origins along directions (N, 3).

    Where it `has_moved`, the scene was made with its meshes elsewhere.
    """

    def __init__(
        self, gpu: Gpu, scene: Scene, kernel: Callable[..., ComputePass], *, has_moved: bool
    ) -> None:
        self.gpu, self.commands, self._kernel = gpu.scope(), Commands(gpu), kernel
        aside = np.eye(4)
        aside[:3, 3] = 1.0, 2.0, 3.0
        elsewhere = [
            replace(mesh, world_from_object=aside @ mesh.world_from_object) for mesh in scene.meshes
        ]
        made = replace(scene, meshes=tuple(elsewhere)) if has_moved else scene
        self.meshes = GpuScene(self.gpu, made)
        self.scene = RayScene(self.gpu, self.meshes)
        if has_moved:
            self.move(scene)

    def move(self, scene: Scene) -> None:
        self.scene.update(scene)

    def send(self, origin: Any, direction: Any, t_min: float = 0.0, t_max: float = 3e38) -> Found:
        count = len(direction)
        from_ = np.empty((count, 4), np.float32)
        from_[:, :3], from_[:, 3] = origin, t_min
        towards = np.empty((count, 4), np.float32)
        towards[:, :3], towards[:, 3] = direction, t_max
        scope = self.gpu.scope()
        given = [buffer_of(scope, "rays", data) for data in (from_, towards)]
        found = buffer_of(scope, "found", np.zeros((5 * count, 4), np.float32))
        self._kernel(self.scene.constants).dispatch(
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
        is_hit = words[:, 0, 1] != NO_HIT
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
        )


@pytest.fixture
def rays(gpu: Gpu, tmp_path: Path) -> Any:
    """rays(scene, has_moved=False) -> Rays."""
    made: list[Rays] = []
    kernels: dict[tuple[Any, ...], ComputePass] = {}
    path = tmp_path / "rays_kernel.wgsl"
    path.write_text(_KERNEL)
    members = {"slots": _SLOTS, "workgroup": (64, 1, 1), "file": str(path), "__module__": __name__}
    kind = type("RaysKernel", (ComputePass,), members)

    def kernel(constants: dict[str, float]) -> ComputePass:
        key = tuple(constants.items())
        if key not in kernels:
            kernels[key] = kind(gpu, constants=constants)
        return kernels[key]

    def make(scene: Scene, has_moved: bool = False) -> Rays:
        made.append(Rays(gpu, scene, kernel, has_moved=has_moved))
        return made[-1]

    yield make
    for one in made:
        one.gpu.release()
