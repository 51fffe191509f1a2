"""Stages and their times; the arena of uniforms, and when it is full."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.gpu.layout import Struct, vec4f
from airlight.gpu.memory import Buffer
from airlight.gpu.slots import storage, uniform


class Given(Struct):
    """A value."""

    value = vec4f()


@pytest.fixture
def work(kernel, gpu, owned):
    """work(commands) encodes one dispatch that writes `results`."""
    add = kernel(
        "@compute @workgroup_size(WX, WY, WZ)\n"
        "fn main(@builtin(global_invocation_id) id: vec3u) {\n"
        "    if (id.x == 0u) { results[0] += params.value.x; }\n}\n",
        (uniform("params", Given), storage("results", "f32", "read_write")),
    )
    results = owned(Buffer(gpu, "results", 16))
    results.write(np.zeros(4, np.float32))

    def encode(commands: Commands) -> Buffer:
        add.dispatch(commands, (1,), params=Given(value=(1, 0, 0, 0)), results=results)
        return results

    return encode


def test_untimed_stages_cost_no_submit_and_keep_no_times(commands, work):
    with commands.stage("outer"):
        results = work(commands)
    assert results.read()[0] == 0.0  # still only encoded
    commands.submit()
    assert results.read()[0] == 1.0
    assert commands.stage_ms == {}


def test_a_cpu_adapter_is_timed_by_the_wall_clock(commands, work, monkeypatch):
    monkeypatch.setattr(Gpu, "is_cpu", property(lambda self: True))
    commands.is_timed = True
    for _ in range(2):
        with commands.stage("first"):
            work(commands)
            with commands.stage("inner"):
                results = work(commands)
    with commands.stage("second"):
        work(commands)
    assert results.read()[0] == 5.0  # each stage was submitted and waited for
    assert list(commands.stage_ms) == ["first", "second"]  # an inner stage belongs to its outer
    assert all(0.0 < ms < 60_000 for ms in commands.stage_ms.values())


def test_a_gpu_is_timed_by_its_timestamps(gpu, work, monkeypatch):
    # The mechanism only: what a CPU adapter writes as timestamps means nothing.
    if "timestamp-query" not in gpu.features:
        pytest.skip("the adapter has no timestamp queries")
    monkeypatch.setattr(Gpu, "is_cpu", property(lambda self: False))
    commands = Commands(gpu)
    commands.is_timed = True
    for name in ("first", "second", "first"):
        with commands.stage(name):
            results = work(commands)
    assert results.read()[0] == 0.0  # stages of a GPU are not submitted one by one
    commands.submit()
    commands.collect_timestamps()
    assert results.read()[0] == 3.0
    assert set(commands.stage_ms) == {"first", "second"}
    assert all(np.isfinite(ms) for ms in commands.stage_ms.values())
    commands.stage_ms.clear()
    commands.collect_timestamps()
    assert commands.stage_ms == {}  # collected once


def test_an_error_inside_a_stage_leaves_the_encoder_usable(commands, work):
    with pytest.raises(KeyError), commands.stage("broken"):
        work(commands)
        raise KeyError("broken")
    results = work(commands)
    commands.submit()
    assert results.read()[0] == 2.0


def test_more_uniforms_than_fit_are_refused(commands):
    with pytest.raises(RuntimeError, match="uniform arena is full"):
        for index in range(1 << 16):
            commands.put(Given(value=(index, 0, 0, 0)))


def test_a_frame_has_any_number_of_passes(kernel, gpu, commands, owned):
    """More parameters than the arena holds: what is encoded before goes ahead of the rest."""
    add = kernel(
        "@compute @workgroup_size(WX, WY, WZ)\n"
        "fn main(@builtin(global_invocation_id) id: vec3u) {\n"
        "    if (id.x == 0u) { results[0] += params.value.x; results[1] += params.value.y; }\n}\n",
        (uniform("params", Given), storage("results", "f32", "read_write")),
    )
    results = owned(Buffer(gpu, "results", 16))
    results.write(np.zeros(4, np.float32))
    for k in range(5000):
        add.dispatch(commands, (1,), params=Given(value=(1, k % 8, 0, 0)), results=results)
    commands.submit()
    assert results.read()[:2].tolist() == [5000.0, 5000.0 * 3.5]


def test_the_same_parameters_have_one_place_until_the_submit(commands):
    first, other = Given(value=(1, 0, 0, 0)), Given(value=(1, 0, 0, 0))
    places = [commands.put(given) for given in (first, other, first)]
    assert places[0] == places[2] != places[1]
    commands.encoder  # noqa: B018  (something to submit)
    commands.submit()
    assert commands.put(other) == places[0]


def test_untimed_stages_share_one_compute_pass(commands, work):
    with commands.stage("first"):
        work(commands)
        opened = commands.compute
    with commands.stage("second"):
        work(commands)
        assert commands.compute is opened
