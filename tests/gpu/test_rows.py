"""Rows in textures: shaders read what Python wrote, of structs every field."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import DeviceError
from airlight.gpu.layout import Struct, f32, pack_array, vec2f, vec4f
from airlight.gpu.memory import Buffer
from airlight.gpu.rows import LINE, Rows, Table, rows, rows_of, table
from airlight.gpu.slots import storage

from .test_layout import STRUCTS, expected_words, scalars, values_of

_READ = """
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < arrayLength(&results)) { results[id.x] = row_of_given(id.x); }
}
"""


@pytest.mark.parametrize("struct", STRUCTS)
def test_a_shader_reads_the_structs_of_a_table(gpu, commands, kernel, owned, struct):
    values = [values_of(struct, seed) for seed in range(4)]
    words = scalars(struct, "one")
    stores = [f"    results[id.x * {len(words)}u + {k}u] = {w};" for k, w in enumerate(words)]
    head = "@compute @workgroup_size(WX, WY, WZ)\n"
    begin = "fn main(@builtin(global_invocation_id) id: vec3u) {\n    if (id.x >= 4u) { return; }\n"
    one = "    let one = row_of_given(id.x);\n"
    read = kernel(
        head + begin + one + "\n".join(stores) + "\n}",
        (table("given", struct), storage("results", "u32", "read_write")),
    )
    results = owned(Buffer(gpu, "results", 4 * len(words) * 4))
    given = owned(Table(gpu, "given", struct, 4))
    given.write(pack_array(struct, values))
    read.dispatch(commands, (4,), given=given, results=results)
    commands.submit()
    expected = np.concatenate([expected_words(v) for v in values])
    np.testing.assert_array_equal(results.read(np.uint32), expected)


def test_a_struct_takes_whole_rows():
    class Odd(Struct):
        """Five words."""

        a = vec4f()
        b = f32()

    class Short(Struct):
        """Two words."""

        a = vec2f()

    assert rows_of(Odd) == 2
    with pytest.raises(ValueError, match="Short"):
        rows_of(Short)


@pytest.mark.parametrize(
    ("first", "count"),
    [(0, 5), (LINE - 2, 4), (LINE, LINE), (7, 2 * LINE), (2 * LINE - 1, LINE + 2), (0, 0)],
)
def test_what_is_written_lies_there_and_nowhere_else(gpu, commands, kernel, owned, first, count):
    total = 4 * LINE
    before = np.arange(4 * total, dtype=np.uint32).reshape(-1, 4)
    written = np.full((count, 4), 0xABCD, np.uint32)
    written[:, 1] = np.arange(count)
    given = owned(Rows(gpu, "given", total))
    given.write(before)
    given.write(written, first)
    results = owned(Buffer(gpu, "results", 16 * total))
    read = kernel(_READ, (rows("given"), storage("results", "vec4u", "read_write")))
    read.dispatch(commands, (total,), given=given, results=results)
    commands.submit()
    expected = before.copy()
    expected[first : first + count] = written
    np.testing.assert_array_equal(results.read(np.uint32).reshape(-1, 4), expected)


def test_more_rows_than_the_device_has_room_for_are_refused(gpu):
    lines = gpu.limits["max-texture-dimension-2d"]
    with pytest.raises(DeviceError, match="too long a list"):
        Rows(gpu, "too long a list", lines * LINE + 1)
