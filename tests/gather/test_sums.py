"""Sums of gather points as images: what one pass stores is what the next one reads."""

from __future__ import annotations

import numpy as np

from airlight.gather.sums import PointSums, read_sums, sums_image, written_sums
from airlight.gpu.memory import buffer_of
from airlight.gpu.slots import storage

SIZE = (5, 3)
_STORE = """
//! use stored_sums
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < 5u && id.y < 3u) { store_sums(id.xy, given[id.y * 5u + id.x]); }
}
"""
_READ = """
//! use point_sums
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < 5u && id.y < 3u) { found[id.y * 5u + id.x] = sums_at(sums, id.xy); }
}
"""


class _Points:
    reduced = SIZE


def test_an_image_of_sums_holds_every_field(gpu, commands, kernel, owned):
    count = SIZE[0] * SIZE[1]
    words = PointSums.dtype.itemsize // 4
    values = np.arange(1, count * words + 1, dtype=np.float32)
    # What lies between fields is nobody's.
    is_field = np.zeros(words, bool)
    for field, (_, offset, *_) in zip(
        PointSums.fields.values(), PointSums.dtype.fields.values(), strict=True
    ):
        is_field[offset // 4 : (offset + field.size) // 4] = True
    image = owned(sums_image(gpu, "sums", _Points()))
    given = owned(buffer_of(gpu, "given", values))
    found = owned(buffer_of(gpu, "found", np.zeros_like(values)))
    store = kernel(_STORE, (storage("given", PointSums), written_sums()))
    read = kernel(_READ, (read_sums("sums"), storage("found", PointSums, "read_write")))
    store.dispatch(commands, SIZE, given=given, sums_after=image)
    read.dispatch(commands, SIZE, sums=image, found=found)
    commands.submit()
    kept = found.read(np.float32).reshape(count, words)
    np.testing.assert_array_equal(kept[:, is_field], values.reshape(count, words)[:, is_field])
