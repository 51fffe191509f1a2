"""Recorded dispatches: the same as encoded ones, until what they depend on is another."""

from __future__ import annotations

import gc
import weakref
from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from cffi import FFI
from tests.gpu.small import SMALL

from airlight.gpu import recorded
from airlight.gpu.commands import Commands
from airlight.gpu.layout import Struct, f32, u32
from airlight.gpu.memory import Buffer
from airlight.gpu.recorded import Recorded, direct_calls
from airlight.gpu.sliced import SlicedCommands
from airlight.gpu.slots import storage, uniform
from airlight.rendering import Renderer
from airlight.scene.io import load
from airlight.scene.medium import Medium


class Given(Struct):
    """A step of x -> a x + b."""

    place = u32()
    factor = f32()


class Added(Struct):
    """What is added."""

    value = f32()


STEPS = 5


@pytest.fixture
def run(kernel, gpu):
    """run(commands, results, added) encodes STEPS dispatches over two pipelines."""
    slots = (
        uniform("given", Given),
        uniform("added", Added),
        storage("results", "f32", "read_write"),
    )
    body = (
        "@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {\n"
        "    if (id.x == 0u) {\n        let x = results[given.place];\n"
        "        results[given.place] = given.factor * x + SIGN * added.value;\n    }\n}\n"
    )
    plus = kernel("const SIGN = 1.0;\n" + body, slots)
    minus = kernel("const SIGN = -0.5;\n" + body, slots)

    def encode(commands: Commands, results: Buffer, added: Added) -> str:
        for step in range(STEPS):
            which = minus if step == 2 else plus
            given = Given.of(place=step // 3, factor=2.0 + step)
            which.dispatch(commands, (1,), given=given, added=added, results=results)
        return "done"

    return encode


def expected(added: float, start: float = 1.0) -> list[float]:
    values = [start, start]
    for step in range(STEPS):
        sign = -0.5 if step == 2 else 1.0
        values[step // 3] = (2.0 + step) * values[step // 3] + sign * added
    return values


def fresh(results: Buffer) -> None:
    results.write(np.ones(4, np.float32))


class Runs:
    """A recording of `run`, and how often that was encoded again."""

    def __init__(self, gpu, run, results, added) -> None:
        self.count, self.run, self.results, self.added = 0, run, results, added
        self.recorded = Recorded(gpu, "test")

    def encoded(self, commands: Commands, results: Buffer | None = None) -> list[float]:
        results = results or self.results
        fresh(results)
        found = self.recorded.encode(commands, (results,), lambda: self.record(commands, results))
        assert found == "done"
        commands.submit()
        return results.read()[:2].tolist()

    def record(self, commands: Commands, results: Buffer) -> str:
        self.count += 1
        return self.run(commands, results, self.added)


@pytest.fixture
def runs(gpu, run, owned):
    return Runs(gpu, run, owned(Buffer(gpu, "results", 16)), Added(value=0.25))


@pytest.mark.parametrize("is_quick", [True, False])
def test_a_replay_is_the_same(runs, commands, monkeypatch, is_quick):
    if not is_quick:  # as with a wgpu-py whose insides are others
        monkeypatch.setattr(recorded, "_CALLS", None)
    for _ in range(3):
        assert runs.encoded(commands) == pytest.approx(expected(0.25))
    assert runs.count == 1


def test_a_library_whose_functions_are_known_is_called_itself():
    assert recorded._CALLS is not None


def test_other_resources_and_other_commands_are_recorded_again(gpu, runs, commands, owned):
    other = owned(Buffer(gpu, "other results", 16))
    for results, count in ((runs.results, 1), (other, 2), (other, 2), (runs.results, 2)):
        assert runs.encoded(commands, results) == pytest.approx(expected(0.25))
        assert runs.count == count
    assert runs.encoded(Commands(gpu)) == pytest.approx(expected(0.25))
    assert runs.count == 3


def test_as_many_recordings_are_kept_as_were_used_last(gpu, runs, commands, owned):
    results = [owned(Buffer(gpu, f"results {k}", 16)) for k in range(recorded._MOST + 1)]
    held = gpu.allocated_bytes
    fresh(results[0])
    for k in (*range(recorded._MOST), 0):  # all in one submit, the first twice
        runs.recorded.encode(commands, (results[k],), lambda k=k: runs.record(commands, results[k]))
    each = (gpu.allocated_bytes - held) // recorded._MOST
    assert each >= 256
    assert runs.count == recorded._MOST
    # One more, in the same submit: that of results 1 makes room.
    fresh(results[1])
    fresh(results[-1])
    runs.recorded.encode(commands, ("more",), lambda: runs.record(commands, results[-1]))
    commands.submit()
    assert gpu.allocated_bytes == held + recorded._MOST * each
    for one in (results[1], results[-1]):
        assert one.read()[:2].tolist() == pytest.approx(expected(0.25))
    for k, count in ((0, 0), (2, 0), (1, 1), (2, 1)):
        assert runs.encoded(commands, results[k]) == pytest.approx(expected(0.25))
        assert runs.count == recorded._MOST + 1 + count
    runs.recorded.release()
    assert gpu.allocated_bytes == held


def test_what_a_recording_names_lives_as_long_as_it(gpu, runs, commands, kernel):
    slots = (uniform("added", Added), storage("results", "f32", "read_write"))
    add = kernel(
        "@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {\n"
        "    if (id.x == 0u) { results[0] += added.value; }\n}\n",
        slots,
    )

    def filled(value: float) -> weakref.ref[Buffer]:
        """A buffer that nobody keeps, but for what is recorded."""
        kept = Buffer(gpu, "kept", 16)
        fresh(kept)
        runs.recorded.encode(
            commands,
            (kept,),
            lambda: add.dispatch(commands, (1,), added=Added(value=value), results=kept),
        )
        commands.submit()
        assert kept.read()[0] == pytest.approx(1.0 + value)
        return weakref.ref(kept)

    held = gpu.allocated_bytes
    found = [filled(float(value)) for value in range(recorded._MOST)]
    gc.collect()
    # None is gone, so no new one has the id of one that is named by a key.
    assert len({id(one()) for one in found} - {id(None)}) == recorded._MOST
    add.bindings._groups.clear()
    found.append(filled(9.0))
    add.bindings._groups.clear()
    gc.collect()
    assert [one() is None for one in found] == [True] + [False] * recorded._MOST
    runs.recorded.release()
    gc.collect()
    assert all(one() is None for one in found)
    assert gpu.allocated_bytes == held


def test_numbers_are_compared_by_value(runs, commands):
    def encode(key: tuple[object, ...]) -> None:
        runs.recorded.encode(commands, key, lambda: runs.record(commands, runs.results))

    for key in ((3, (0.5, 0.25)), (3, (0.5, 2 * 0.125)), (2 + 1, (1 / 2, 0.25))):
        encode(key)
    assert runs.count == 1
    encode((3, (0.5, 0.26)))
    assert runs.count == 2
    commands.submit()


def test_two_beside_each_other_in_one_submit_keep_their_own(gpu, run, owned, commands):
    both = [
        Runs(gpu, run, owned(Buffer(gpu, "results", 16)), Added(value=value))
        for value in (0.5, 9.0)
    ]
    for _ in range(3):
        for one in both:
            fresh(one.results)
            for _ in range(2):  # one replayed twice, too
                one.recorded.encode(commands, (), lambda r=one: r.record(commands, r.results))
        commands.submit()
        for one in both:
            once = expected(one.added.record["value"])
            got = one.results.read()[:2].tolist()
            assert got[0] == pytest.approx(expected(one.added.record["value"], once[0])[0])
    assert [one.count for one in both] == [1, 1]


def test_dispatches_after_a_replay_have_their_own_pipeline(runs, run, commands):
    fresh(runs.results)
    runs.encoded(commands)
    fresh(runs.results)
    runs.recorded.encode(commands, (runs.results,), lambda: "")
    run(commands, runs.results, Added(value=1.5))
    commands.submit()
    first, second = expected(0.25)
    want = [expected(1.5, first)[0], expected(1.5, second)[1]]
    assert runs.results.read()[:2].tolist() == pytest.approx(want)


def test_a_recording_inside_a_recording_belongs_to_it(gpu, runs, commands):
    outer = Recorded(gpu, "outer")

    def inside() -> str:
        runs.recorded.encode(commands, (), lambda: runs.record(commands, runs.results))
        return "outer"

    for _ in range(3):
        fresh(runs.results)
        assert outer.encode(commands, (), inside) == "outer"
        commands.submit()
        assert runs.results.read()[:2].tolist() == pytest.approx(expected(0.25))
    assert runs.count == 1


def test_work_in_slices_is_encoded_pass_by_pass(gpu, runs):
    sliced = SlicedCommands(gpu, nullcontext)
    for count in (1, 2):
        assert runs.encoded(sliced) == pytest.approx(expected(0.25))
        assert runs.count == count


@pytest.mark.parametrize("what", ["copy", "submit", "indirect"])
def test_only_dispatches_are_recorded(gpu, runs, commands, owned, kernel, what):
    groups = owned(Buffer(gpu, "groups", 16, indirect=True))
    slots = (storage("results", "f32", "read_write"),)
    text = "@compute @workgroup_size(WX, WY, WZ) fn main() { results[3] = 1.0; }"
    by_device = kernel(text, slots)

    def wrong() -> None:
        if what == "copy":
            commands.encoder.clear_buffer(runs.results.handle)
        elif what == "submit":
            commands.submit()
        else:
            by_device.dispatch_indirect(commands, groups, results=runs.results)

    with pytest.raises(RuntimeError, match="recorded"):
        runs.recorded.encode(commands, (runs.results,), wrong)
    # Nothing of it is left.
    assert runs.encoded(commands) == pytest.approx(expected(0.25))
    assert runs.encoded(commands) == pytest.approx(expected(0.25))
    assert runs.count == 1


def lit(scene, share: float):
    """The scene's lights, so many times as bright."""
    return tuple(replace(x, intensity=tuple(share * v for v in x.intensity)) for x in scene.lights)


@pytest.mark.parametrize("technique", ["lpv", "lpv-scatter"])
def test_renderers_beside_each_other_draw_what_fresh_ones_do(gpu, technique):
    scene = load("builtin:cornell")
    if technique == "lpv-scatter":
        scene = replace(scene, medium=Medium((0.1, 0.1, 0.1), (0.9, 0.9, 0.9)))
    steps = [(1.0, (24, 18)), (2.0, (24, 18)), (0.5, (30, 20))]

    def image(renderer: Renderer, share: float, size: tuple[int, int]) -> np.ndarray:
        renderer.resize(size)
        return renderer.frame(lights=lit(scene, share)).radiance

    def fresh(share: float, size: tuple[int, int]) -> np.ndarray:
        with Renderer(scene, technique, size, settings=SMALL) as renderer:
            return image(renderer, share, size)

    with (
        Renderer(scene, technique, (24, 18), settings=SMALL) as a,
        Renderer(scene, technique, (24, 18), settings=SMALL) as b,
    ):
        for share, size in steps:
            of_a, of_b = image(a, share, size), image(b, 3.0 * share, (24, 18))
    np.testing.assert_array_equal(of_a, fresh(share, size))
    np.testing.assert_array_equal(of_b, fresh(3.0 * share, (24, 18)))
    assert of_a.max() > 0.0


def test_functions_of_another_library_are_not_called() -> None:
    ffi = FFI()
    ffi.cdef("int abs(int);")
    other = SimpleNamespace(
        wgpuComputePassEncoderSetPipeline=ffi.dlopen(None).abs,
        wgpuComputePassEncoderSetBindGroup=ffi.dlopen(None).abs,
        wgpuComputePassEncoderDispatchWorkgroups=ffi.dlopen(None).abs,
    )
    assert direct_calls(other, ffi) is None
    assert direct_calls(SimpleNamespace(), ffi) is None
