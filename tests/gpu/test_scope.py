"""What a scope owns goes as a whole, what others own stays."""

from __future__ import annotations

import gc

from airlight.gpu.memory import Buffer, Texture
from airlight.gpu.recorded import Recorded


def test_all_that_was_made_in_a_scope_goes_with_it(gpu):
    before = gpu.allocated_bytes
    outer = gpu.scope()
    inner = outer.scope()
    made = [
        Buffer(outer, "buffer", 1000),
        Texture(outer, "texture", (16, 8), "rgba8unorm"),
        Buffer(inner, "buffer within", 500),
    ]
    assert gpu.allocated_bytes == outer.allocated_bytes == before + 1000 + 16 * 8 * 4 + 500
    outer.release()
    assert gpu.allocated_bytes == before
    assert [part.handle for part in made] == [None] * 3
    outer.release()  # once more does no harm
    assert gpu.allocated_bytes == before


def test_a_scope_leaves_alone_what_others_own(gpu):
    outer = gpu.scope()
    inner, other = outer.scope(), outer.scope()
    kept = [Buffer(gpu, "of the device", 16), Buffer(outer, "outer", 16), Buffer(other, "o", 16)]
    held = gpu.allocated_bytes
    dropped = Buffer(inner, "dropped early", 400)
    inner.release()
    assert dropped.handle is None
    assert all(part.handle is not None for part in kept)
    assert gpu.allocated_bytes == held
    outer.release()
    assert kept[0].handle is not None


def test_a_scope_can_be_used_again(gpu):
    scope = gpu.scope()
    for size in (100, 200):
        before = gpu.allocated_bytes
        made = Buffer(scope, "of a size", size)
        assert gpu.allocated_bytes == before + size
        scope.release()
        assert made.handle is None
        assert gpu.allocated_bytes == before


def test_recordings_go_with_their_scope(gpu, commands, kernel):
    from airlight.gpu.slots import storage

    scope = gpu.scope()
    numbers = Buffer(gpu, "numbers", 256)
    wgsl = "@compute @workgroup_size(WX, WY, WZ)\nfn main() { numbers[0] = 1.0; }"
    step = kernel(wgsl, (storage("numbers", "f32", "read_write"),))
    recorded, before = Recorded(scope, "run"), gpu.allocated_bytes
    recorded.encode(commands, (numbers,), lambda: step.dispatch(commands, (1,), numbers=numbers))
    assert gpu.allocated_bytes > before
    scope.release()
    assert gpu.allocated_bytes == before
    commands.submit()


def test_a_scope_keeps_nothing_alive(gpu):
    """What is created again without a release goes as any object of Python."""
    scope, before = gpu.scope(), gpu.allocated_bytes
    for _ in range(3):
        made = Buffer(scope, "the last one counts", 64)
        gc.collect()
        assert gpu.allocated_bytes == before + 64
    del made
    gc.collect()
    assert gpu.allocated_bytes == before


def test_scopes_share_the_device_and_what_is_known_of_it(gpu):
    scope = gpu.scope()
    assert scope.device is gpu.device
    assert scope.pipelines is gpu.pipelines
    assert scope.facts is gpu.facts
    assert scope.peak_bytes == gpu.peak_bytes
