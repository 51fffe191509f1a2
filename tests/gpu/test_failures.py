"""What the device refuses becomes one DeviceError, and only that."""

from __future__ import annotations

import sys

import pytest
import wgpu

from airlight.errors import DeviceError, SettingsError
from airlight.gpu.device import AdapterInfo, adapters
from airlight.gpu.failures import MEMORY_REMEDY, is_alive, refused

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


def test_to_ask_whether_a_device_is_alive_leaves_nothing_behind(gpu):
    def kept():
        counts = wgpu.diagnostics.wgpu_native_counts.get_dict()
        return {kind: row["count"] for kind, row in counts.items()}

    before = kept()
    assert all(is_alive(gpu) for _ in range(3))
    assert kept() == before


@pytest.fixture(scope="module")
def cpu_adapter() -> AdapterInfo:
    """One whose memory is the process's, or a skip."""
    found = [info for info in adapters() if info.is_cpu]
    if not found:
        pytest.skip("no CPU adapter: only its memory can be limited")
    return found[0]


LIMITED = pytest.mark.skipif(
    sys.platform != "linux", reason="limits a process's memory as Linux does"
)


@LIMITED
@pytest.mark.parametrize("is_written", [False, True])
def test_memory_that_runs_out_is_said_and_what_was_drawn_before_goes_on(
    child, cpu_adapter, is_written
):
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


@LIMITED
@pytest.mark.parametrize("is_found", [False, True])
def test_too_little_memory_to_open_the_device_is_said(child, cpu_adapter, is_found):
    said = child(f"""
    import resource
    from airlight.gpu.device import adapters, open_gpu
    if {is_found}:
        adapters()
    held = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + (60 << 20), resource.RLIM_INFINITY))
    try:
        open_gpu("cpu")
    except al.DeviceError as error:
        print(error)
    """)
    least = 128 if is_found else 512
    said_first = f"less than {least} MiB of memory are left for the graphics driver"
    assert said == [f"{said_first}. {MEMORY_REMEDY}"]


@LIMITED
def test_the_command_line_says_it_in_one_line_and_exits_with_2(child, cpu_adapter, tmp_path):
    said = child(f"""
    import resource, sys
    from airlight.app import cli
    from airlight.gpu.device import open_gpu
    gpu = open_gpu("cpu")
    held = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + (300 << 20), resource.RLIM_INFINITY))
    asked = ["render", "builtin:cornell", "--adapter", "cpu", "--technique", "direct", "-o",
             {str(tmp_path / "a.png")!r}, "--samples", "1"]
    code = cli.run([*asked, "--size", "4000x4000"])
    print(code)
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    from airlight.sampled_view import SampledView
    draw = SampledView.draw
    def lost(self, *args):
        gpu.device.destroy()
        return draw(self, *args)
    SampledView.draw = lost
    print(cli.run([*asked, "--size", "8x8"]))
    SampledView.draw = draw
    print(cli.run([*asked, "--size", "8x8"]))
    """)
    assert [line for line in said if line.isdigit()] == ["2", "2", "0"]
    errors = [line for line in said if line.startswith("error: ")]
    assert len(errors) == 2
    assert "no memory" in errors[0] and errors[0].endswith(MEMORY_REMEDY)
    assert errors[1].startswith("error: the device was lost: ") and errors[1].endswith(LOST)
    assert not any("internal error" in line or "DEVICE LOST" in line for line in said)
