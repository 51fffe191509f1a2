"""What a ray costs: from the camera, and from what it sees into a half space, by the cosine."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...gpu.commands import Commands
from ...gpu.compute import ComputePass
from ...gpu.device import Gpu, open_gpu
from ...gpu.layout import Struct, f32, mat4x4f, vec2u, vec3f
from ...gpu.memory import Buffer
from ...gpu.slots import storage, uniform
from ...lighting.view import View
from ...rays.rays import RAY_SLOTS, RayScene
from ...scene.io import load
from ...surface.geometry import GpuScene

if TYPE_CHECKING:
    from ...scene.scene import Scene
    from ..progress import Report

SCENES = ("builtin:room", "builtin:atrium")
SIZE, QUICK_SIZE = (640, 360), (48, 27)
KINDS = ("camera", "cosine", "cosine, any hit")


class RayBenchParams(Struct):
    """The camera."""

    world_from_clip = mat4x4f()
    eye = vec3f("m")
    reach = f32("m, of the scene")
    size = vec2u("px")


class _RayBench(ComputePass):
    """A ray a pixel, of one of KINDS; from the last's hits to the next's origins."""

    slots = (
        uniform("params", RayBenchParams),
        storage("starts", "vec4f", "read_write"),
        *RAY_SLOTS,
    )
    workgroup = (8, 8, 1)
    file = "rays.wgsl"


def measure(
    adapter: str, scenes: Sequence[str], report: Report, *, quick: bool = False
) -> dict[str, Any]:
    """{"size", "cases": [{scene, triangles, bytes, build_s, kinds: {kind: {rays, ms, cpu_ms}}}]}.

    The least of some runs; `build_s` and `cpu_ms` are processor time. Raises DeviceError.
    """
    size, runs = (QUICK_SIZE, 1) if quick else (SIZE, 5)
    cases = []
    names = scenes or (SCENES[:1] if quick else SCENES)
    for index, name in enumerate(names):
        report(f"rays in {name}", index / len(names))
        # Each scene has a scope of its own on the device, so that none pays for another's memory.
        gpu = open_gpu(adapter).scope()
        try:
            cases.append({"scene": name, **_case(gpu, load(name), size, runs)})
        finally:
            gpu.release()
    return {"size": size, "cases": cases}


def _case(gpu: Gpu, scene: Scene, size: tuple[int, int], runs: int) -> dict[str, Any]:
    meshes = GpuScene(gpu, scene)
    # What building the hierarchies costs the host.
    begin_s = time.process_time()
    rays = RayScene(gpu, meshes)
    build_s = time.process_time() - begin_s
    # Rays through the camera's pixels; later kinds start where those hit.
    view = View(gpu, size)
    view.aim(scene.camera)
    starts = Buffer(gpu, "starts of rays", 48 * size[0] * size[1])
    low, high = meshes.bounds if scene.meshes else (np.zeros(3), np.ones(3))
    params = RayBenchParams(
        world_from_clip=np.linalg.inv(view.clip_from_world),
        eye=scene.camera.position,
        reach=float(np.linalg.norm(high - low)),
        size=size,
    )
    # Each kind of ray is a kernel of its own, whose first run compiles and is left out.
    kinds = {}
    for number, kind in enumerate(KINDS):
        generated = f"const KIND = {number}u;"
        bench = _RayBench(gpu, constants=rays.constants, generated=generated)
        values = {"params": params, "starts": starts, **rays.bound}
        _timed(gpu, bench, size, values)  # compiles
        ms, cpu_ms = zip(*(_timed(gpu, bench, size, values) for _ in range(runs)), strict=True)
        # Later kinds start only where the camera's rays hit.
        sent = _sent(starts, size) if number else size[0] * size[1]
        kinds[kind] = {"rays": sent, "ms": min(ms), "cpu_ms": min(cpu_ms)}
    return {**rays.stats, "build_s": build_s, "kinds": kinds}


def _timed(
    gpu: Gpu, bench: ComputePass, size: tuple[int, int], values: dict[str, Any]
) -> tuple[float, float]:
    """Milliseconds by the clock and of the processor."""
    commands = Commands(gpu)
    # All of the host's and the device's work for one dispatch.
    begin_s, begin_cpu_s = time.perf_counter(), time.process_time()
    bench.dispatch(commands, size, **values)
    commands.submit()
    gpu.wait()
    return (time.perf_counter() - begin_s) * 1e3, (time.process_time() - begin_cpu_s) * 1e3


def _sent(starts: Buffer, size: tuple[int, int]) -> int:
    """How many pixels see something, which the other rays start from."""
    rows: NDArray[np.float32] = starts.read(np.float32)[: 12 * size[0] * size[1]].reshape(-1, 3, 4)
    return int((rows[:, 0, 3] > 0.0).sum())
