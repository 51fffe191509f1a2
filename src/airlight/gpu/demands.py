"""What a pass needs of a device, checked against its limits before the pass is created.

A driver's own refusal names neither the pass nor a remedy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import wgpu

from ..errors import DeviceError
from .device import Gpu
from .failures import refused
from .slots import Slot, on_device

REMEDY = "Use another adapter or technique, or fewer volumes and kinds of lights"
_TARGET_BYTES = {  # of a sample, as the WebGPU specification counts them: (bytes, alignment)
    "r8unorm": (1, 1),
    "rgba8unorm": (8, 1),
    "rgba8unorm-srgb": (8, 1),
    "bgra8unorm": (8, 1),
    "bgra8unorm-srgb": (8, 1),
    "r16float": (2, 2),
    "rg16float": (4, 2),
    "rgba16float": (8, 2),
    "r32float": (4, 4),
    "rg32float": (8, 4),
    "rgba32float": (16, 4),
    "r32uint": (4, 4),
    "rg32uint": (8, 4),
    "rgba32uint": (16, 4),
    "r16uint": (2, 2),
    "rg16uint": (4, 2),
    "rgba16uint": (8, 2),
    "rgb10a2unorm": (8, 4),
    "rgba8uint": (4, 1),
    "r8uint": (1, 1),
}


def largest_binding(gpu: Gpu) -> int:
    """The most bytes of a storage buffer that a pass may read as a whole."""
    return min(gpu.limits["max-storage-buffer-binding-size"], gpu.limits["max-buffer-size"])


def slot_demands(slots: Iterable[Slot]) -> dict[str, int]:
    """How many bindings of each kind a stage that sees all `slots` has, by the limit on them."""
    listed = list(slots)
    return {limit: sum(map(is_one, listed)) for limit, is_one in _KINDS.items()}


def _buffer(slot: Slot) -> str:
    return str(slot.layout.get("buffer", {}).get("type", ""))


_KINDS: dict[str, Callable[[Slot], bool]] = {
    "max-storage-buffers-per-shader-stage": lambda slot: "storage" in _buffer(slot),
    "max-uniform-buffers-per-shader-stage": lambda slot: _buffer(slot) == "uniform",
    "max-sampled-textures-per-shader-stage": lambda slot: "texture" in slot.layout,
    "max-samplers-per-shader-stage": lambda slot: "sampler" in slot.layout,
    "max-storage-textures-per-shader-stage": lambda slot: "storage_texture" in slot.layout,
    "max-dynamic-uniform-buffers-per-pipeline-layout": (
        lambda slot: slot.is_dynamic and _buffer(slot) == "uniform"
    ),
    "max-dynamic-storage-buffers-per-pipeline-layout": (
        lambda slot: slot.is_dynamic and "storage" in _buffer(slot)
    ),
}


def target_bytes(formats: Iterable[str]) -> int:
    """Bytes that a sample of all render targets takes, as the limit on them counts."""
    # Each format starts at a multiple of its alignment, as WebGPU counts.
    end = 0
    for format in formats:
        size, align = _TARGET_BYTES[format]
        end = -(-end // align) * align + size
    return end


def fits(gpu: Gpu, slots: Iterable[Slot]) -> bool:
    """Whether the device binds so many resources in one pass."""
    made = on_device(tuple(slots), gpu)
    return all(count <= gpu.limits[limit] for limit, count in slot_demands(made).items())


def check_slots(gpu: Gpu, label: str, slots: Iterable[Slot]) -> None:
    """Raise DeviceError where the device binds fewer resources than the pass `label` has."""
    for limit, count in slot_demands(slots).items():
        gpu.require(limit, count, f"pass '{label}'", remedy=REMEDY)


def check_workgroup(gpu: Gpu, label: str, workgroup: tuple[int, int, int]) -> None:
    """Raise DeviceError where the device has smaller workgroups than the pass `label`."""
    # Each side of a workgroup, then all of it.
    for axis, size in zip("xyz", workgroup, strict=True):
        gpu.require(f"max-compute-workgroup-size-{axis}", size, f"pass '{label}'", remedy=REMEDY)
    x, y, z = workgroup
    limit = "max-compute-invocations-per-workgroup"
    gpu.require(limit, x * y * z, f"pass '{label}'", remedy=REMEDY)


def check_targets(gpu: Gpu, label: str, formats: tuple[str, ...]) -> None:
    """Raise DeviceError where the device draws into fewer targets at once than `label` does."""
    what = f"pass '{label}'"
    gpu.require("max-color-attachments", len(formats), what, remedy=REMEDY)
    limit = "max-color-attachment-bytes-per-sample"
    gpu.require(limit, target_bytes(formats), what, remedy=REMEDY)


def compiled(gpu: Gpu, label: str, make: Callable[[], Any]) -> Any:
    """The pipeline that `make` creates for the pass `label`.

    A driver's refusal is raised as a DeviceError that names the pass.
    """
    try:
        return make()
    except wgpu.GPUError as error:
        reason = " ".join(str(error).split())
        raise refused(gpu, error) or DeviceError(
            f"{gpu.info.name} refuses the pass '{label}': {reason}", remedy=REMEDY
        ) from error
