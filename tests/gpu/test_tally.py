"""What passes bind and run is counted by stage, and nothing where nobody asks."""

from __future__ import annotations

from airlight.app.bench.frames import counted
from airlight.gpu.commands import Commands
from airlight.gpu.compute import ComputePass
from airlight.gpu.memory import Buffer
from airlight.gpu.slots import storage
from airlight.gpu.tally import Count, Tally
from airlight.rendering import Renderer
from airlight.scene.builtin import builtin_scene


class Doubled(ComputePass):
    slots = (storage("a", "f32"), storage("b", "f32", "read_write"))
    workgroup = (64, 1, 1)
    file = "doubled.wgsl"


def test_bytes_and_threads_of_a_dispatch(gpu, tmp_path, monkeypatch):
    shader = tmp_path / "doubled.wgsl"
    shader.write_text(
        "@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u)"
        " { b[id.x] = 2.0 * a[id.x]; }"
    )
    monkeypatch.setattr("airlight.gpu.compute.shader_path", lambda cls: shader)
    made, commands = Doubled(gpu), Commands(gpu)
    a, b = (Buffer(gpu, name, 400) for name in "ab")
    commands.tally = Tally()
    with commands.stage("doubling"):
        made.dispatch(commands, (100,), a=a, b=b)
    assert commands.tally.stages == {"doubling": Count(passes=1, invocations=128, nbytes=800)}
    tally, commands.tally = commands.tally, None
    made.dispatch(commands, (100,), a=a, b=b)
    commands.submit()
    assert tally.stages["doubling"].passes == 1


def test_a_frame_counts_its_stages_and_goes_on_as_before(gpu):
    settings = {
        "resolution": 8,
        "surfels": 1000,
        "shadow_resolution": 32,
        "lamp_resolution": 16,
        "sky_lights": 0,
    }
    with Renderer(builtin_scene("cornell"), "lpv", (16, 16), settings=settings) as renderer:
        counts = counted(renderer)
        assert renderer.commands.tally is None and renderer.commands.is_recordable
        assert counts["lighting"]["invocations"] >= 16 * 16
        assert counts["g-buffer"]["nbytes"] > 0 and counts["propagate"]["passes"] > 1
