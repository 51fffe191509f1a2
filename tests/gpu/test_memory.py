"""Textures and buffers: what is written is read; what is released is given back."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.code_paths import CPU_PATHS, GPU_PATHS
from airlight.gpu.memory import Buffer, BufferPart, Texture, buffer_of

FORMATS = {
    "r8unorm": (np.uint8, 1),
    "rgba8unorm": (np.uint8, 4),
    "rgba8unorm-srgb": (np.uint8, 4),
    "rgba8snorm": (np.int8, 4),
    "r16float": (np.float16, 1),
    "rg16float": (np.float16, 2),
    "rgba16float": (np.float16, 4),
    "r32float": (np.float32, 1),
    "rg32float": (np.float32, 2),
    "rgba32float": (np.float32, 4),
    "r32uint": (np.uint32, 1),
}


def texels(format: str, shape: tuple[int, ...], seed: int = 0) -> np.ndarray:
    dtype, channels = FORMATS[format]
    rng = np.random.default_rng(seed)
    whole = (*shape, channels) if channels > 1 else shape
    if np.issubdtype(dtype, np.floating):
        return rng.normal(size=whole).astype(dtype)
    # -128 and -127 are the same snorm
    low = max(-127, int(np.iinfo(dtype).min))
    return rng.integers(low, np.iinfo(dtype).max, size=whole, endpoint=True, dtype=dtype)


@pytest.mark.parametrize("format", FORMATS)
def test_an_image_comes_back(gpu, owned, format):
    given = texels(format, (3, 5))
    made = owned(Texture(gpu, "image", (5, 3), format))
    made.write(given)
    np.testing.assert_array_equal(made.read(), given)


@pytest.mark.parametrize("format", FORMATS)
def test_a_volume_comes_back(gpu, owned, format):
    given = texels(format, (2, 3, 5))
    made = owned(Texture(gpu, "volume", (5, 3, 2), format, dimension="3d"))
    made.write(given)
    np.testing.assert_array_equal(made.read(), given)


@pytest.mark.parametrize("format", ["rgba8unorm", "r32float", "rgba16float"])
def test_array_layers_come_back_one_by_one_and_together(gpu, owned, format):
    made = owned(Texture(gpu, "layers", (5, 3, 4), format, dimension="2d-array"))
    layers = [texels(format, (3, 5), seed) for seed in range(4)]
    for index in (2, 0, 3, 1):
        made.write(layers[index], layer=index)
    np.testing.assert_array_equal(made.read(2), layers[2])
    np.testing.assert_array_equal(made.read(), np.stack(layers))


@pytest.mark.parametrize("rows", [1, 3, 4, 7, 8])
def test_what_no_buffer_holds_comes_back_in_parts(gpu, owned, monkeypatch, rows):
    given = texels("rgba16float", (3, 4, 5))
    made = owned(Texture(gpu, "layers", (5, 4, 3), "rgba16float", dimension="2d-array"))
    made.write(given)
    monkeypatch.setitem(gpu.limits, "max-buffer-size", 256 * rows)
    np.testing.assert_array_equal(made.read(), given)
    np.testing.assert_array_equal(made.read(layer=2), given[2])


def test_what_nobody_released_is_not_counted_when_it_is_gone(gpu):
    before = gpu.allocated_bytes
    kept = [Texture(gpu, "image", (5, 3), "r8unorm"), Buffer(gpu, "numbers", 64)]
    assert gpu.allocated_bytes > before
    kept[0].release()
    kept.clear()
    assert gpu.allocated_bytes == before


def test_an_array_may_be_written_whole(gpu, owned):
    made = owned(Texture(gpu, "layers", (5, 3, 2), "r32float", dimension="2d-array"))
    given = texels("r32float", (2, 3, 5))
    made.write(given)
    np.testing.assert_array_equal(made.read(), given)


def test_the_wrong_type_is_refused(gpu, owned):
    made = owned(Texture(gpu, "albedo", (5, 3), "rgba8unorm"))
    with pytest.raises(TypeError, match=r"^albedo: rgba8unorm takes uint8, not float32$"):
        made.write(np.zeros((3, 5, 4), np.float32))


def test_views_of_layers_are_made_once(gpu, owned):
    made = owned(Texture(gpu, "maps", (4, 4, 3), "rgba8unorm", dimension="2d-array", target=True))
    assert made.layer(1) is made.layer(1)
    assert made.layer(1) is not made.layer(2)


@pytest.mark.parametrize("dtype", [np.float32, np.int32, np.uint8])
def test_a_buffer_comes_back(gpu, owned, dtype):
    given = np.arange(32).astype(dtype)
    np.testing.assert_array_equal(owned(buffer_of(gpu, "b", given)).read(dtype)[:32], given)


def test_part_of_a_buffer_is_written(gpu, owned):
    made = owned(buffer_of(gpu, "b", np.zeros(8, np.float32)))
    made.write(np.array([5.0, 6.0], np.float32), offset=12)
    np.testing.assert_array_equal(made.read(), [0, 0, 0, 5, 6, 0, 0, 0])


def test_an_empty_buffer_can_be_bound(gpu, owned):
    assert owned(buffer_of(gpu, "b", np.zeros(0, np.float32))).nbytes == 16


def test_released_memory_is_given_back(gpu):
    before = gpu.allocated_bytes
    made = [
        Buffer(gpu, "b", 1000),
        Texture(gpu, "t", (16, 8), "rgba32float"),
        Texture(gpu, "v", (4, 4, 4), "rgba16float", dimension="3d"),
        Texture(gpu, "m", (16, 16), "rgba8unorm", mips=5),
    ]
    expected = 1000 + 16 * 8 * 16 + 64 * 8 + 16 * 16 * 4 * 4 // 3
    assert gpu.allocated_bytes == before + expected
    assert gpu.peak_bytes >= gpu.allocated_bytes
    for part in made:
        part.release()
        part.release()  # twice does no harm
    assert gpu.allocated_bytes == before


def test_a_part_of_a_buffer_is_bound_and_read_as_one(gpu):
    before = gpu.allocated_bytes
    whole = Buffer(gpu, "whole", 512)
    part = BufferPart(whole, BufferPart.ALIGNMENT, 16)
    whole.write(np.zeros(128, np.float32))
    part.write(np.arange(1.0, 4.0, dtype=np.float32), 4)
    assert part.read().tolist() == [0.0, 1.0, 2.0, 3.0]
    assert whole.read()[64:68].tolist() == [0.0, 1.0, 2.0, 3.0]
    part.release()
    del part
    assert gpu.allocated_bytes == before + 512
    whole.release()


@pytest.mark.parametrize(("taken", "submits"), [(CPU_PATHS, 0), (GPU_PATHS, 3)])
def test_parts_of_an_upload_are_handed_over_where_that_keeps_nobody_waiting(
    gpu, owned, monkeypatch, taken, submits
):
    """A submit waits on a CPU adapter until all before it is done: not for 20 MB."""
    monkeypatch.setattr(gpu, "paths", taken)
    given = np.arange(20 << 18, dtype=np.uint32)
    made = owned(Buffer(gpu, "20 MB", given.nbytes))
    submit, handed = type(gpu.queue).submit, []
    with monkeypatch.context() as patch:
        patch.setattr(
            type(gpu.queue), "submit", lambda queue, work: (handed.append(1), submit(queue, work))
        )
        made.write(given)
    assert len(handed) == submits
    np.testing.assert_array_equal(made.read(np.uint32), given)
