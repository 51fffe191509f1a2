"""Which adapter is chosen and why; limits said as messages."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from airlight.errors import DeviceError
from airlight.gpu.device import (
    NO_DRIVER_REMEDY,
    AdapterInfo,
    Gpu,
    adapters,
    choose,
    chosen_reason,
    open_gpu,
)
from airlight.gpu.memory import Buffer, Texture


def info(name: str, kind: str, index: int = 0) -> AdapterInfo:
    return AdapterInfo(name, kind, "Vulkan", "driver 1", "vendor", index)


BIG = info("GeForce RTX 4090", "DiscreteGPU")
SMALL = info("UHD Graphics", "IntegratedGPU", 1)
SOFT = info("llvmpipe (LLVM 15)", "CPU", 2)
LISTED = "GeForce RTX 4090 (DiscreteGPU), UHD Graphics (IntegratedGPU), llvmpipe (LLVM 15) (CPU)"


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [
        ("auto", BIG),
        ("AUTO", BIG),
        ("cpu", SOFT),
        ("gpu", BIG),
        ("uhd", SMALL),
        ("LLVMpipe", SOFT),
        ("Graphics", SMALL),
    ],
)
def test_choice(wanted, expected):
    assert choose([BIG, SMALL, SOFT], wanted) is expected


def test_no_driver_at_all():
    with pytest.raises(DeviceError) as caught:
        choose([])
    assert str(caught.value) == f"no graphics driver was found. {NO_DRIVER_REMEDY}"
    assert "apt install mesa-vulkan-drivers" in NO_DRIVER_REMEDY


@pytest.mark.parametrize(
    ("found", "wanted", "message"),
    [
        (
            [SOFT],
            "gpu",
            "no adapter matches 'gpu'; there is llvmpipe (LLVM 15) (CPU). Use --adapter auto",
        ),
        (
            [BIG],
            "cpu",
            "no adapter matches 'cpu'; there is GeForce RTX 4090 (DiscreteGPU). "
            + NO_DRIVER_REMEDY,
        ),
        (
            [BIG, SMALL, SOFT],
            "Radeon",
            f"no adapter matches 'Radeon'; there is {LISTED}. "
            "Use auto, cpu, gpu or a part of a name",
        ),
    ],
)
def test_what_is_not_there_is_said(found, wanted, message):
    with pytest.raises(DeviceError) as caught:
        choose(found, wanted)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("found", "chosen", "wanted", "reason"),
    [
        ([SOFT], SOFT, "auto", "the only adapter"),
        ([BIG, SMALL, SOFT], BIG, "auto", "DiscreteGPU comes before CPU, IntegratedGPU"),
        ([BIG, SOFT], SOFT, "cpu", "asked for by 'cpu'"),
    ],
)
def test_the_reason_is_said(found, chosen, wanted, reason):
    assert chosen_reason(found, chosen, wanted) == reason


def test_adapters_are_listed_best_first_and_never_opengl(gpu):
    found = adapters()
    assert gpu.info in found
    assert "OpenGL" not in {a.backend for a in found}
    order = ["DiscreteGPU", "IntegratedGPU", "VirtualGPU", "CPU", "Unknown", "Other"]
    ranks = [order.index(a.adapter_type) for a in found]
    assert ranks == sorted(ranks)


LOADED = """
from pathlib import Path
from airlight.gpu.device import adapters
def loaded(): return sorted({line.split("/")[-1].split(".")[0]
                             for line in Path("/proc/self/maps").read_text().splitlines()
                             if "libEGL" in line})
"""


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="libraries are not listed")
def test_opengl_is_not_loaded_to_find_adapters(child):
    (said,) = child(f"{LOADED}\nprint(len(adapters()) > 0, loaded())")
    if "libEGL_nvidia" in said:
        pytest.skip("NVIDIA's Vulkan driver loads libEGL itself")
    assert said == "True []"


def test_an_instance_of_another_user_of_wgpu_is_shared(child):
    said = child(
        """
import wgpu
theirs = wgpu.gpu.request_adapter_sync()
from airlight.gpu.device import adapters
print({a.backend for a in adapters()} & {"OpenGL"}, made().frame().radiance.any())
print(theirs.request_device_sync().adapter is theirs)
"""
    )
    assert said == ["set() True", "True"]


def test_another_user_of_wgpu_may_come_after(child):
    said = child(
        """
import wgpu
print(made().frame().radiance.any())
theirs = wgpu.gpu.request_adapter_sync()
print(theirs.request_device_sync().adapter is theirs)
"""
    )
    assert said == ["True", "True"]


def test_the_device_is_opened_once(gpu):
    assert open_gpu(gpu.info.name) is gpu


def message_of(gpu: Gpu, what: str, limit: str, value: int) -> str:
    return (
        f"{what} needs {limit} = {value}, {gpu.info.name} has {gpu.limits[limit]}. Make it smaller"
    )


@pytest.mark.parametrize(
    ("size", "dimension", "limit", "value"),
    [
        ((1 << 20, 4), "2d", "max-texture-dimension-2d", 1 << 20),
        ((4, 1 << 20), "2d", "max-texture-dimension-2d", 1 << 20),
        ((4, 4, 1 << 20), "3d", "max-texture-dimension-3d", 1 << 20),
        ((4, 4, 1 << 20), "2d-array", "max-texture-array-layers", 1 << 20),
    ],
)
def test_a_texture_beyond_the_limits_is_refused(gpu, size, dimension, limit, value):
    before = gpu.allocated_bytes
    with pytest.raises(DeviceError) as caught:
        Texture(gpu, "huge", size, "r8unorm", dimension=dimension)
    assert str(caught.value) == message_of(gpu, "texture 'huge'", limit, value)
    assert gpu.allocated_bytes == before


def test_a_buffer_beyond_the_limits_is_refused(gpu):
    with pytest.raises(DeviceError) as caught:
        Buffer(gpu, "huge", 1 << 50)
    assert str(caught.value) == message_of(gpu, "buffer 'huge'", "max-buffer-size", 1 << 50)


def test_waiting_returns_once_work_is_done(gpu, owned):
    buffer = owned(Buffer(gpu, "waited", 64))
    buffer.write(np.arange(16, dtype=np.float32))
    gpu.wait()
    np.testing.assert_array_equal(buffer.read(), np.arange(16))
