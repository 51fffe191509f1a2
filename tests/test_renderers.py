"""Many renderers at once, one in many threads, closed ones, and ones that an error broke off."""

from __future__ import annotations

import dataclasses
import gc
import signal
import threading

import numpy as np
import pytest

from airlight.errors import DeviceError, SceneError, SettingsError
from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.gpu.memory import Buffer, Texture, _Counted
from airlight.rendering import Renderer
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Material,
    Mesh,
    PointLight,
    Scene,
)
from airlight.scene import Texture as SceneTexture
from airlight.surface.gbuffer import GBuffer

SMALL = {"resolution": 8, "shadow_resolution": 32, "lamp_resolution": 16, "surfels": 500}
LPV = {**SMALL, "map_resolution": 16, "iterations": 4}
LIGHT = PointLight((0.3, 2.0, 0.5), (5.0, 5.0, 5.0))


@pytest.fixture(scope="module")
def scene(square) -> Scene:
    """A floor and a wall under a lamp."""
    floor, wall = square((0, 0, 0), (2, 0, 0), (0, 0, -2)), square((2, 1, 0), (0, 0, 1), (0, 1, 0))
    return Scene((floor, wall), (LIGHT,), camera=Camera((0, 2, 5), (0, 0, 0)))


def direct(scene: Scene, **named: object) -> Renderer:
    return Renderer(scene, "direct", (16, 12), settings=SMALL, **named)


THREADS = """
import threading
fog = al.Medium((0.1, 0.1, 0.1))
foggy = al.Scene(scene.meshes, scene.lights, camera=scene.camera, medium=fog)
kinds = [("direct", scene, small), ("lpv", scene, {**small, "map_resolution": 16}),
         ("lpv-scatter", foggy, {**small, "map_resolution": 16})]
def drawn(kind):
    name, shown, settings = kinds[kind]
    with al.Renderer(shown, name, (16, 16), settings=settings) as renderer:
        return [renderer.frame(samples=samples).radiance for samples in (1, 2, 1)]
def run(count, work):
    said, threads = [], []
    def guarded(index):
        try:
            said.append(work(index))
        except BaseException as error:
            said.append(f"{type(error).__name__}: {error}")
    threads = [threading.Thread(target=guarded, args=(i,)) for i in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return said
"""


def test_a_renderer_per_thread_draws_what_one_alone_does(child):
    said = child(
        THREADS
        + """
# The threads come first: the device is opened, and pipelines are compiled, by all of them.
found = {}
def work(index):
    for _ in range(1 + index // 3):
        found.setdefault(index % 3, []).append(drawn(index % 3))
    return "done"
print(*run(6, work))
alone = {kind: drawn(kind) for kind in range(3)}
print(all(np.array_equal(one, alone[kind]) for kind in found for one in found[kind]))
print(al.Renderer(scene, size=(8, 8)).gpu.allocated_bytes > 0)
"""
    )
    assert said == [" ".join(["done"] * 6), "True", "True"]


def test_one_renderer_in_many_threads_is_refused_and_goes_on(child):
    said = child(
        THREADS
        + """
renderer = made()
alone = renderer.frame().radiance
together = threading.Barrier(3)
def work(index):
    refused = 0
    for _ in range(20):
        together.wait()
        try:
            renderer.frame(samples=4)
        except al.DeviceError as error:
            assert str(error).startswith("this Renderer is used by two threads at once"), error
            refused += 1
    return refused
refused = run(3, work)
print(all(isinstance(count, int) for count in refused), 0 < sum(refused) < 60, refused)
print(np.array_equal(renderer.frame().radiance, alone))
print(*run(1, lambda index: np.array_equal(renderer.frame().radiance, alone)))
print(*run(1, lambda index: renderer.close()))
"""
    )
    assert said[0].startswith("True True"), said
    assert said[1:] == ["True", "True", "None"]


def test_a_frame_that_is_drawn_keeps_other_threads_out(gpu, scene):
    said: list[str] = []

    def other() -> None:
        for ask in (r.frame, r.timed_passes, lambda: r.resize((8, 8)), r.close):
            with pytest.raises(DeviceError) as caught:
                ask()
            said.append(str(caught.value))

    def progress(stage: str, share: float) -> None:
        thread = threading.Thread(target=other)
        thread.start()
        thread.join()
        assert r.stats()["triangles"] == 4

    with direct(scene) as r:
        alone = r.frame(samples=2)
        again = r.frame(samples=2, progress=progress)
        np.testing.assert_array_equal(again.radiance, alone.radiance)
    assert len(said) == 8
    assert set(said) == {
        "this Renderer is used by two threads at once. "
        "Make a Renderer for each thread, or a lock around the one that they share"
    }


def test_a_renderer_may_move_to_another_thread(gpu, scene):
    found = []

    def other() -> None:
        r.resize((8, 6))
        r.resize((16, 12))
        found.append(r.frame().radiance)
        r.close()

    r = direct(scene)
    alone = r.frame().radiance
    thread = threading.Thread(target=other)
    thread.start()
    thread.join()
    np.testing.assert_array_equal(found[0], alone)


@pytest.mark.parametrize("ask", ["frame", "timed_passes", "stats", "resize"])
def test_a_closed_renderer_says_so(gpu, scene, ask):
    before = gpu.allocated_bytes
    r = direct(scene)
    r.frame(samples=2)
    r.close()
    r.close()
    with pytest.raises(DeviceError, match=r"^this Renderer is closed\. Make a new one$"):
        getattr(r, ask)(*[(8, 8)] if ask == "resize" else [])
    assert gpu.allocated_bytes == before


def broken_off(monkeypatch, owner: type, name: str, at: int, error: BaseException) -> list[int]:
    """The method raises `error` when it is called for the `at`-th time."""
    original, calls = getattr(owner, name), [0]

    def breaking(self, *args, **named):
        calls[0] += 1
        if calls[0] == at:
            raise error
        return original(self, *args, **named)

    monkeypatch.setattr(owner, name, breaking)
    return calls


@pytest.mark.parametrize(
    ("owner", "name", "at", "error"),
    [
        (Commands, "submit", 2, KeyboardInterrupt()),
        (Commands, "put", 1, KeyboardInterrupt()),
        (Commands, "put", 9, RuntimeError("broken")),
        (Gpu, "wait", 1, KeyboardInterrupt()),
        (GBuffer, "encode", 1, MemoryError()),
        (Texture, "read", 2, KeyboardInterrupt()),
    ],
)
@pytest.mark.parametrize("technique", ["direct", "lpv"])
def test_a_frame_that_breaks_off_never_was(
    gpu, scene, monkeypatch, technique, owner, name, at, error
):
    before = gpu.allocated_bytes
    elsewhere = dataclasses.replace(LIGHT, position=(-1.0, 1.0, 0.5))
    settings = LPV if technique == "lpv" else SMALL
    with Renderer(scene, technique, (16, 12), settings=settings) as r:
        first = r.frame(samples=2).radiance
        moved = r.frame(lights=[elsewhere], samples=2).radiance
        held = gpu.allocated_bytes
        r.frame(lights=[LIGHT], samples=2)
        with monkeypatch.context() as patch:
            broken_off(patch, owner, name, at, error)
            expected = DeviceError if isinstance(error, MemoryError) else type(error)
            with pytest.raises(expected):
                r.frame(lights=[elsewhere], camera=Camera((0, 9, 0), (0, 0, 1)), samples=2)
        np.testing.assert_array_equal(r.frame(samples=2).radiance, first)
        np.testing.assert_array_equal(r.frame(lights=[elsewhere], samples=2).radiance, moved)
        assert gpu.allocated_bytes == held
    assert gpu.allocated_bytes == before


def test_refused_arguments_change_nothing(gpu, scene):
    with direct(scene) as r:
        first = r.frame().radiance
        with pytest.raises(SettingsError):
            r.frame(lights=[DirectionalLight((0, -1, 0), (1, 1, 1))])
        with pytest.raises(SceneError):
            r.frame(meshes=scene.meshes[:1])
        np.testing.assert_array_equal(r.frame().radiance, first)


def test_a_resize_that_breaks_off_keeps_the_size(gpu, scene, monkeypatch):
    with direct(scene) as r:
        first = r.frame().radiance
        with monkeypatch.context() as patch:
            broken_off(patch, GBuffer, "resize", 1, KeyboardInterrupt())
            with pytest.raises(KeyboardInterrupt):
                r.resize((32, 24))
        assert r.size == (16, 12)
        np.testing.assert_array_equal(r.frame().radiance, first)


@pytest.mark.parametrize("made", [1, 3, 10])
@pytest.mark.parametrize("kind", [Texture, Buffer])
def test_a_renderer_that_cannot_be_made_leaves_nothing(gpu, scene, monkeypatch, kind, made):
    before = gpu.allocated_bytes
    with monkeypatch.context() as patch:
        broken_off(patch, kind, "__init__", made, KeyboardInterrupt())
        with pytest.raises(KeyboardInterrupt):
            Renderer(scene, "lpv", (16, 12), settings=LPV)
    gc.collect()
    assert gpu.allocated_bytes == before


def test_a_lost_device_is_reopened_for_the_next_frame(child):
    said = child("""
    renderer = made()
    before = renderer.frame(samples=2).radiance
    for ask in (renderer.frame, lambda: renderer.resize((8, 8)), renderer.timed_passes):
        renderer.gpu.device.destroy()
        try:
            ask()
        except al.DeviceError as error:
            print(str(error).partition(":")[0], "Make a new Renderer" in str(error))
        with made() as other:
            print(np.array_equal(other.frame(samples=2).radiance, before))
        print(np.array_equal(renderer.frame(samples=2).radiance, before))
    """)
    assert said == ["the device was lost True", "True", "True"] * 3


def test_a_device_lost_before_anything_was_drawn_says_so(child):
    said = child("""
    with made() as renderer:
        renderer.gpu.device.destroy()
        try:
            renderer.frame(samples=2)
        except al.DeviceError as error:
            print(str(error).partition(":")[0])
    """)
    assert said == ["the device was lost"]


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="this system has no such timer")
def test_interrupted_at_any_moment_it_goes_on(child):
    said = child("""
    import random, signal
    def stop(*_):
        raise KeyboardInterrupt
    signal.signal(signal.SIGALRM, stop)
    rng, broken = random.Random(5), 0
    renderer = made()
    before = renderer.frame(samples=2).radiance
    for _ in range(60):
        try:
            signal.setitimer(signal.ITIMER_REAL, rng.uniform(1e-4, 0.03))
            for _ in range(20):  # an interrupt within a destructor is lost
                renderer.frame(samples=2)
                renderer.resize((20, 20))
                renderer.resize((16, 16))
            signal.setitimer(signal.ITIMER_REAL, 0)
        except KeyboardInterrupt:
            broken += 1
    renderer.resize((16, 16))  # one that was interrupted leaves the size before
    print(broken > 20, np.array_equal(renderer.frame(samples=2).radiance, before))
    """)
    assert "True True" in said  # among what Python says of interrupts that destructors lost
    assert not any(line.startswith("exit code") for line in said)


@pytest.fixture(scope="module")
def painted(square) -> Scene:
    """A floor with a map under a lamp, and a sky with a map."""
    rng = np.random.default_rng(4)
    pixels = rng.integers(0, 256, (64, 64, 4), np.uint8)
    pixels[..., 3] = 255
    material = Material("floor", base_color_texture=SceneTexture(pixels), emission=(0.1, 0.0, 0.0))
    floor = square((0, 0, 0), (2, 0, 0), (0, 0, -2), material)
    sky = Environment(map=rng.random((32, 64, 3), np.float32))
    camera = Camera((0, 2, 5), (0, 0, 0))
    return Scene((floor, Mesh(floor.geometry)), (LIGHT,), sky, camera=camera)


UPLOADS = ("packed maps", "vertices", "positions", "indices", "triangle table", "environment")


def labelled(monkeypatch) -> list[str]:
    """The labels of all that is made on the device from here on."""
    labels: list[str] = []
    hold = _Counted._hold
    monkeypatch.setattr(
        _Counted, "_hold", lambda self, gpu: (labels.append(self.label), hold(self, gpu))[1]
    )
    return labels


def test_renderers_of_one_scene_hold_one_upload(gpu, painted, monkeypatch):
    labels, before, count = labelled(monkeypatch), gpu.allocated_bytes, len(gpu.uploads)
    with direct(painted) as one:
        image = one.frame().radiance
        first, own = set(labels), gpu.allocated_bytes - before
        labels.clear()
        two = direct(dataclasses.replace(painted))
        np.testing.assert_array_equal(two.frame().radiance, image)
        # Copies of its meshes and maps would be the same, too: a file that is read again.
        assert set(UPLOADS) - {"packed maps", "triangle table"} <= first
        assert not set(labels) & set(UPLOADS)
        assert gpu.allocated_bytes - before < 2 * own
    # The other one goes on with what both had.
    np.testing.assert_array_equal(two.frame().radiance, image)
    two.close()
    assert (gpu.allocated_bytes, len(gpu.uploads)) == (before, count)


def test_what_one_renderer_changes_the_other_does_not_show(painted, square):
    """Lights of materials, vertices and the sky, each in one of two renderers of one scene."""
    floor, wall = painted.meshes
    glowing = dataclasses.replace(floor.material, emission=(3.0, 0.0, 0.0))
    bent = dataclasses.replace(
        floor.geometry, positions=floor.geometry.positions + np.float32((0, 0.5, 0))
    )
    edits = [
        {"meshes": (dataclasses.replace(floor, material=glowing), wall)},
        {"meshes": tuple(dataclasses.replace(m, geometry=bent) for m in painted.meshes)},
        {"environment": dataclasses.replace(painted.environment, scale=3.0)},
    ]
    alone = []
    for edit in edits:
        with direct(painted) as only:
            alone.append(only.frame(**edit).radiance)
    with direct(painted) as one, direct(painted) as two:
        plain = one.frame().radiance
        two.frame()
        for edit, expected in zip(edits, alone, strict=True):
            assert not np.array_equal(expected, plain)
            back = {name: getattr(painted, name) for name in edit}
            for changed, other in ((one, two), (two, one)):
                for _ in range(3):  # encoded, recorded, replayed
                    np.testing.assert_array_equal(changed.frame(**edit).radiance, expected)
                    np.testing.assert_array_equal(other.frame().radiance, plain)
                np.testing.assert_array_equal(changed.frame(**back).radiance, plain)
