"""The soak finds what grows, and small ones find nothing."""

from __future__ import annotations

import pytest

from airlight.techniques import TECHNIQUES
from soak.__main__ import main
from soak.levels import Course, Level, objects_now
from soak.moving import SETTINGS, moved, scene

MIB = 2**20


def course(process, device=(10,), objects=((("Buffer", 3),),)):
    count = max(len(process), len(device), len(objects))
    long = [
        [*values, *[values[-1]] * (count - len(values))] for values in (process, device, objects)
    ]
    levels = [Level(int(p * MIB), d * MIB, dict(o)) for p, d, o in zip(*long, strict=True)]
    return Course("frames", levels)


def test_what_is_flat_is_flat():
    assert course([100.0] * 9).grown() == []
    assert course([100.0, 100.2, 104.0, 100.5, 100.1, 100.9]).grown() == [], "a spike is no growth"
    assert course([100.0], [10, 12, 10]).grown() == []


def test_what_grows_is_named():
    assert course([100.0 + 0.5 * k for k in range(9)]).grown() == [
        "memory of the process 100.5 MiB -> 103.5 MiB"
    ]
    assert course([100.0], [10, 11]).grown() == ["memory of the device 10.0 MiB -> 11.0 MiB"]
    more = (("Buffer", 3),), (("Buffer", 40), ("Sampler", 17), ("Texture", 16))
    assert course([100.0], objects=more).grown() == [
        "Buffer objects 3 -> 40",
        "Sampler objects 0 -> 17",
    ]


def test_everything_moves_in_every_frame():
    first, second = moved(0), moved(1)
    assert first["camera"] != second["camera"] and first["lights"] != second["lights"]
    assert (first["environment"].map != second["environment"].map).any()
    assert (first["volumes"][0].density != second["volumes"][0].density).any()
    _, wall, sheet = zip(first["meshes"], second["meshes"], strict=True)
    assert (wall[0].world_from_object != wall[1].world_from_object).any()
    assert (sheet[0].geometry.positions != sheet[1].geometry.positions).any()
    assert set(SETTINGS) == set(TECHNIQUES)
    assert scene().triangle_count > 100


def test_a_leak_is_heard(gpu, monkeypatch, capsys):
    from airlight.gpu.memory import Texture
    from airlight.rendering import Renderer

    kept, frame = [], Renderer.frame

    def leaks(self, **what):
        kept.extend(Texture(self.gpu, "leak", (64, 64), "rgba8unorm") for _ in range(16))
        return frame(self, **what)

    monkeypatch.setattr(Renderer, "frame", leaks)
    small = ["--frames", "4", "--renderers", "0", "--resizes", "0", "--size", "16x9"]
    try:
        assert main([*small, "--technique", "direct", "--slack", "999"]) == 1
    finally:
        for texture in kept:
            texture.release()
    told = capsys.readouterr().out
    assert "grew: memory of the device" in told and "grew: Texture objects" in told


def test_what_wgpu_native_keeps_is_counted(gpu):
    """A command buffer that is never submitted stays there when Python's object is gone."""
    before = objects_now()["native CommandBuffer"]
    for _ in range(3):
        gpu.device.create_command_encoder().finish()
    assert objects_now()["native CommandBuffer"] == before + 3


def test_a_drop_of_it_is_flat(gpu, capsys):
    small = ["--frames", "4", "--renderers", "2", "--resizes", "4", "--size", "16x9"]
    assert main([*small, "--technique", "direct", "--slack", "64"]) == 0, capsys.readouterr().out
    assert capsys.readouterr().out.count("\n") == 4


@pytest.mark.slow
def test_a_cup_of_it_is_flat(gpu, capsys):
    small = ["--frames", "30", "--renderers", "3", "--resizes", "20", "--size", "32x18"]
    assert main([*small, "--slack", "64"]) == 0, capsys.readouterr().out
