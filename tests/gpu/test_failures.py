"""What the device refuses becomes one DeviceError, and only that."""

from __future__ import annotations

import sys

import pytest
import wgpu

from airlight.errors import DeviceError, SettingsError
from airlight.gpu.failures import MEMORY_REMEDY, refused

LOST = "Make a new Renderer; if it is lost again, take another adapter ('cpu' needs no GPU)"


def test_memory_that_ran_out_names_what_it_was_for(gpu):
    text = "Validation Error\n\nCaused by:\n  In wgpuDeviceCreateBuffer, label = 'rows'\n"
    error = refused(gpu, wgpu.GPUValidationError(f"{text}    Not enough memory left."))
    assert str(error).startswith(f"{gpu.info.name} has no memory left for 'rows', beside ")
    assert str(error).endswith(f" MiB that airlight holds. {MEMORY_REMEDY}")
    assert "for '" not in str(refused(gpu, wgpu.GPUOutOfMemoryError("gone")))


def test_the_hosts_memory_is_said_with_its_size(gpu):
    error = refused(gpu, MemoryError("Unable to allocate 3. GiB"))
    assert str(error) == f"no memory is left: Unable to allocate 3. GiB. {MEMORY_REMEDY}"
    assert str(refused(gpu, MemoryError())).startswith("no memory is left: ")


@pytest.mark.parametrize(
    "error",
    [
        wgpu.GPUValidationError("binding 3 is missing"),
        ValueError("out of memory"),
        SettingsError("x"),
        KeyboardInterrupt(),
    ],
)
def test_what_is_no_refusal_goes_through_as_it_is(gpu, error):
    with pytest.raises(type(error)) as caught, gpu.guarded():
        raise error
    assert caught.value is error


def test_a_refusal_is_raised_from_what_wgpu_said(gpu):
    said = wgpu.GPUError("Not enough memory left")
    with pytest.raises(DeviceError) as caught, gpu.guarded():
        raise said
    assert caught.value.__cause__ is said


def test_a_lost_device_says_so_and_the_next_one_asked_for_is_another(child):
    said = child("""
    from airlight.gpu.commands import Commands
    from airlight.gpu.device import open_gpu
    from airlight.gpu.memory import Buffer, Texture
    gpu = open_gpu()
    buffer, texture = Buffer(gpu, "b", 64), Texture(gpu, "t", (4, 4), "r8unorm")
    commands = Commands(gpu)
    commands.encoder
    gpu.device.destroy()
    pixels = np.zeros((4, 4), np.uint8)
    for ask in (gpu.wait, buffer.read, texture.read, lambda: texture.write(pixels),
                commands.submit, lambda: buffer.write(pixels), lambda: Commands(gpu),
                lambda: Buffer(gpu, "c", 64), lambda: Texture(gpu, "t", (4, 4), "r8unorm")):
        try:
            ask()
        except al.DeviceError as error:
            print(error)
    texture.release()
    print(open_gpu() is not gpu, open_gpu() is open_gpu(), made().frame() is not None)
    """)
    name = said[0].removeprefix("the device was lost: ").removesuffix(f". {LOST}")
    assert name and said == [f"the device was lost: {name}. {LOST}"] * 9 + ["True True True"]


@pytest.mark.skipif(sys.platform != "linux", reason="limits a process's memory as Linux does")
@pytest.mark.parametrize("is_written", [False, True])
def test_memory_that_runs_out_is_said_and_what_was_drawn_before_goes_on(child, is_written):
    said = child(f"""
    import resource
    from airlight.gpu.device import open_gpu
    from airlight.gpu.memory import Buffer
    gpu = open_gpu("cpu")
    renderer = al.Renderer(scene, "direct", (16, 16), settings=small, adapter="cpu")
    before = renderer.frame().radiance
    held = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
    limit = resource.RLIMIT_AS
    resource.setrlimit(limit, (held + (200 << 20), resource.RLIM_INFINITY))
    filler, kept = np.zeros(8 << 20, np.uint8), []
    try:
        while True:
            kept.append(Buffer(gpu, "more", 8 << 20))
            if {is_written}:
                kept[-1].write(filler)
                gpu.wait()
    except al.DeviceError as error:
        print(error)
    resource.setrlimit(limit, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    for buffer in kept:
        buffer.release()
    renderer.close()
    again = al.Renderer(scene, "direct", (16, 16), settings=small, adapter="cpu")
    print(np.array_equal(again.frame().radiance, before))
    """)
    assert len(said) == 2
    assert "memory left" in said[0] and said[0].endswith(MEMORY_REMEDY)
    assert said[1] == "True"
