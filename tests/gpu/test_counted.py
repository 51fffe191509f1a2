"""Passes over as many rows of an image as the device has counted."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.compute import ComputePass
from airlight.gpu.counted import FIRST_CORNER, STRIPES, CountedRows
from airlight.gpu.fullscreen import FullscreenPass
from airlight.gpu.layout import Struct, u32, vec2u
from airlight.gpu.memory import Texture
from airlight.gpu.slots import image, storage, uniform

SIZE = (19, 300)  # more rows than stripes, and no multiple of either


class Count(Struct):
    """How many rows there are."""

    size = vec2u("texels")
    rows = u32()
    pad = u32()


PIXEL = "return vec4f(position.xy, f32(params.rows), 1.0);"
DRAWN = (
    f"@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {{ {PIXEL} }}"
)
COUNTED = """
//! use counted_rows
@compute @workgroup_size(WX, WY, WZ) fn main() { store_counted_rows(params.rows, params.size); }
"""
STORED = """
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (all(id.xy < params.size)) { textureStore(stored, id.xy, vec4f(1.0)); }
}
"""


def made(gpu, folder, kind, name, text, slots, **named):
    path = folder / f"{name}.wgsl"
    path.write_text(text)
    members = {"__module__": __name__, "file": str(path), "slots": slots, **named}
    return type(name, (kind,), members)(gpu)


@pytest.mark.both_paths
@pytest.mark.parametrize("rows", [0, 1, 8, 9, 137, 300])
def test_rows_that_are_counted_are_drawn(gpu, commands, owned, tmp_path, rows):
    counted = CountedRows(gpu, "count")
    params = Count(size=SIZE, rows=rows, pad=0)
    slots = (uniform("params", Count),)
    arguments = storage("arguments", "u32", "read_write")
    count = made(
        gpu, tmp_path, ComputePass, "Counts", COUNTED, (*slots, arguments), workgroup=(1, 1, 1)
    )
    draw = made(gpu, tmp_path, FullscreenPass, "Draws", DRAWN, slots, targets=("rgba32float",))
    store = made(
        gpu, tmp_path, ComputePass, "Stores", STORED, (*slots, image("stored", "rgba32float"))
    )
    drawn, stored = (
        owned(Texture(gpu, name, SIZE, "rgba32float", target=True, written=True))
        for name in ("drawn", "stored")
    )
    count.dispatch(commands, (1,), params=params, arguments=counted.arguments)
    draw.draw_rows(commands, (drawn,), counted, params=params)
    store.dispatch_rows(commands, SIZE, counted, params=params, stored=stored)
    commands.submit()
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    seen = drawn.read()
    np.testing.assert_array_equal(seen[:rows, :, 0], x[:rows])
    np.testing.assert_array_equal(seen[:rows, :, 1], y[:rows])
    np.testing.assert_array_equal(stored.read()[:rows], 1.0)
    # Nothing is worked on further down than a stripe, or a row of workgroups.
    groups = -(-rows // 8) * 8
    stripes = int(np.ceil(np.ceil(rows * STRIPES / SIZE[1]) * SIZE[1] / STRIPES))
    assert not seen[groups if draw.stage == "compute" else stripes :].any()
    assert not stored.read()[groups:].any()


def test_a_draw_of_stripes_begins_behind_the_triangle(gpu, commands, tmp_path):
    counted = CountedRows(gpu, "count")
    slots = (uniform("params", Count), storage("arguments", "u32", "read_write"))
    count = made(gpu, tmp_path, ComputePass, "Counts", COUNTED, slots, workgroup=(1, 1, 1))
    params = Count(size=SIZE, rows=150, pad=0)
    count.dispatch(commands, (1,), params=params, arguments=counted.arguments)
    commands.submit()
    expected = [3, 19, 1, 0, 6, 32, FIRST_CORNER, 0]
    np.testing.assert_array_equal(counted.arguments.read(np.uint32), expected)
