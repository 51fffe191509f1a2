"""What a shader binds, in WGSL and in the layout."""

from __future__ import annotations

import pytest

from airlight.gpu.layout import Struct, f32
from airlight.gpu.slots import (
    declarations,
    image,
    on_cpu_adapter,
    sampler,
    storage,
    texture,
    uniform,
)


class Params(Struct):
    """One number."""

    step = f32("m")


@pytest.mark.parametrize(
    ("slot", "declaration"),
    [
        (uniform("params", Params), "var<uniform> params: Params;"),
        (storage("cells", "vec4f"), "var<storage, read> cells: array<vec4f>;"),
        (
            storage("sums", "atomic<i32>", "read_write"),
            "var<storage, read_write> sums: array<atomic<i32>>;",
        ),
        (storage("rows", Params), "var<storage, read> rows: array<Params>;"),
        (texture("t"), "var t: texture_2d<f32>;"),
        (texture("t", "3d", "unfilterable-float"), "var t: texture_3d<f32>;"),
        (texture("t", "2d", "uint"), "var t: texture_2d<u32>;"),
        (texture("t", "2d", "sint"), "var t: texture_2d<i32>;"),
        (texture("t", "2d-array", "depth"), "var t: texture_depth_2d_array;"),
        (sampler("s"), "var s: sampler;"),
        (sampler("s", "comparison"), "var s: sampler_comparison;"),
        (image("out", "rgba16float", "3d"), "var out: texture_storage_3d<rgba16float, write>;"),
    ],
)
def test_declaration(slot, declaration):
    assert slot.declaration == declaration


def test_the_preamble_declares_each_struct_once_and_numbers_bindings():
    slots = (uniform("params", Params), storage("rows", Params), sampler("s"))
    assert declarations(slots, 1) == (
        "struct Params {\n    step: f32,  // m\n}\n"
        "@group(1) @binding(0) var<uniform> params: Params;\n"
        "@group(1) @binding(1) var<storage, read> rows: array<Params>;\n"
        "@group(1) @binding(2) var s: sampler;\n"
    )


def test_only_uniforms_have_offsets_of_their_own():
    assert uniform("params", Params).is_dynamic
    assert not storage("rows", Params).is_dynamic


def test_cpu_adapters_get_uniforms_from_storage():
    slots = (uniform("params", Params), storage("rows", Params), texture("map"))
    turned = on_cpu_adapter(slots)
    assert turned[0].declaration == "var<storage, read> params: Params;"
    assert turned[0].layout["buffer"] == {
        **slots[0].layout["buffer"],
        "type": "read-only-storage",
    }
    assert turned[0].is_dynamic and turned[0].struct is Params
    assert turned[1:] == slots[1:]
    assert slots[0].layout["buffer"]["type"] == "uniform"
