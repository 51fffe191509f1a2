"""Passes that a device cannot bind are one message with their names, before it is asked."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import wgpu

import airlight
from airlight.errors import DeviceError
from airlight.gpu.asked import DEFAULT_LIMITS
from airlight.gpu.bands import BAND
from airlight.gpu.compute import ComputePass
from airlight.gpu.demands import compiled, fits, slot_demands, target_bytes
from airlight.gpu.device import open_gpu
from airlight.gpu.fullscreen import FullscreenPass
from airlight.gpu.layout import Struct, f32
from airlight.gpu.raster import RasterPipeline
from airlight.gpu.slots import image, sampler, storage, texture, uniform


class Params(Struct):
    x = f32()


@pytest.fixture
def plain(gpu):
    return open_gpu(gpu.info.name, "gpu", "default")


def test_bindings_are_counted_by_kind():
    counts = slot_demands(
        (
            uniform("a", Params),
            storage("b", "f32"),
            storage("c", "f32", "read_write"),
            texture("d"),
            sampler("e"),
            image("f", "rgba16float"),
        )
    )
    assert counts == {
        "max-storage-buffers-per-shader-stage": 2,
        "max-uniform-buffers-per-shader-stage": 1,
        "max-sampled-textures-per-shader-stage": 1,
        "max-samplers-per-shader-stage": 1,
        "max-storage-textures-per-shader-stage": 1,
        "max-dynamic-uniform-buffers-per-pipeline-layout": 1,
        "max-dynamic-storage-buffers-per-pipeline-layout": 0,
    }


@pytest.mark.parametrize(
    ("formats", "nbytes"),
    [(("rgba32float", "rgba32float"), 32), (("r8unorm", "r32float"), 8), (("rgba8unorm",), 8)],
)
def test_targets_are_counted_as_webgpu_does(formats, nbytes):
    assert target_bytes(formats) == nbytes


@pytest.mark.parametrize(
    ("make", "limit"),
    [
        (lambda i: storage(f"s{i}", "f32"), "max-storage-buffers-per-shader-stage"),
        (lambda i: texture(f"t{i}"), "max-sampled-textures-per-shader-stage"),
        (lambda i: image(f"i{i}", "rgba16float"), "max-storage-textures-per-shader-stage"),
        (lambda i: uniform(f"u{i}", Params), "max-dynamic-uniform-buffers-per-pipeline-layout"),
    ],
)
def test_one_binding_too_many_names_pass_limit_and_remedy(plain, make, limit):
    most = DEFAULT_LIMITS[limit]

    class Greedy(ComputePass):
        slots = tuple(make(i) for i in range(most + 1))

    assert fits(plain, Greedy.slots[:-1]) and not fits(plain, Greedy.slots)
    with pytest.raises(DeviceError) as caught:
        Greedy(plain)
    assert str(caught.value) == (
        f"pass 'Greedy' needs {limit} = {most + 1}, {plain.info.name} has {most}. "
        "Use another adapter or technique, or fewer volumes and kinds of lights"
    )


def test_workgroups_and_targets_too_large_are_named(plain):
    class Wide(ComputePass):
        slots = ()
        workgroup = (16, 32, 1)

    class Deep(FullscreenPass):
        slots = ()
        targets = ("rgba32float",) * 3

    with pytest.raises(DeviceError, match="'Wide' needs max-compute-invocations-per-workgroup"):
        Wide(plain)
    with pytest.raises(DeviceError, match="'Deep' needs max-color-attachment-bytes-per-sample"):
        Deep(plain)


def test_a_drivers_refusal_names_the_pass(plain):
    def refuse():
        raise wgpu.GPUValidationError("too much\n  of it")

    with pytest.raises(DeviceError, match="refuses the pass 'march': too much of it"):
        compiled(plain, "march", refuse)


def passes(kind: type) -> Iterator[type]:
    """The classes of the package that derive from a kind of pass."""
    for derived in kind.__subclasses__():
        if derived.__module__.startswith("airlight."):
            yield derived
        yield from passes(derived)


def too_many(made: type) -> list[str]:
    """The limits of WebGPU that a pass's slots exceed; of a pass of no slots yet, none."""
    slots = (*getattr(made, "slots", ()), *getattr(made, "second_slots", ()))
    slots += (BAND,) if getattr(made, "in_bands", False) else ()
    counts = slot_demands(slots)
    return [f"{name} = {n}" for name, n in counts.items() if n > DEFAULT_LIMITS[name]]


def test_every_pass_fits_webgpus_default_limits():
    """Those whose slots depend on a scene's media: `tests/techniques/test_default_limits.py`."""
    source = Path(airlight.__file__).parent
    for path in source.rglob("*.py"):
        if re.search(r"\((ComputePass|FullscreenPass|RasterPipeline)\)", path.read_text("utf-8")):
            parts = path.relative_to(source.parent).with_suffix("").parts
            importlib.import_module(".".join(parts))
    found = {*passes(ComputePass), *passes(RasterPipeline)}
    assert len(found) > 150
    over = {made.__name__: limits for made in found if (limits := too_many(made))}
    assert not over, over


def test_a_pass_of_nine_storage_buffers_is_found():
    class Nine(ComputePass):
        slots = (uniform("params", Params), *(storage(f"s{i}", "f32") for i in range(9)))

    assert too_many(Nine) == ["max-storage-buffers-per-shader-stage = 9"]
