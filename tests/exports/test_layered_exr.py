"""Layered EXR, read without the library that wrote it: by the letter of the file format.

https://openexr.com/en/latest/OpenEXRFileLayout.html
"""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest

from airlight.scene.image import Image

SIZE = (20, 7)  # two chunks of 16 rows
ZIP, ROWS_PER_CHUNK = 3, 16
DTYPES = {1: np.dtype("<f2"), 2: np.dtype("<f4")}


def text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def channel_list(data):
    channels, at = [], 0
    while data[at] != 0:
        name, at = text(data, at)
        (kind,) = struct.unpack_from("<i", data, at)
        assert struct.unpack_from("<ii", data, at + 8) == (1, 1)  # sampling
        channels.append((name, DTYPES[kind]))
        at += 16
    return channels


def header_of(data):
    assert struct.unpack_from("<i", data, 0) == (20000630,)
    assert data[4] == 2  # version; no flags: a single part of scan lines
    assert data[5:8] == b"\0\0\0"
    at, attributes = 8, {}
    while data[at] != 0:
        name, at = text(data, at)
        _, at = text(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def undone(packed, size):
    """A ZIP chunk's bytes: deflated unless that made it longer, differences, halves apart."""
    if len(packed) == size:
        return packed
    raw = np.frombuffer(zlib.decompress(packed), np.uint8).astype(np.int64)
    raw[1:] -= 128
    whole = (np.cumsum(raw) & 255).astype(np.uint8)
    half = (size + 1) // 2
    out = np.empty(size, np.uint8)
    out[0::2], out[1::2] = whole[:half], whole[half:]
    return out.tobytes()


def read_exr(path):
    """Channel name -> (H, W)."""
    data = path.read_bytes()
    attributes, at = header_of(data)
    assert attributes["compression"] == bytes([ZIP])
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels = channel_list(attributes["channels"])
    planes = {name: np.zeros((height, width), dtype) for name, dtype in channels}
    for offset in struct.unpack_from(f"<{-(-height // ROWS_PER_CHUNK)}Q", data, at):
        first, packed = struct.unpack_from("<ii", data, offset)
        rows = range(first - y0, min(first - y0 + ROWS_PER_CHUNK, height))
        size = sum(dtype.itemsize * width * len(rows) for _, dtype in channels)
        held, place = undone(data[offset + 8 : offset + 8 + packed], size), 0
        for row in rows:
            for name, dtype in channels:
                planes[name][row] = np.frombuffer(held, dtype, width, place)
                place += dtype.itemsize * width
    return planes


@pytest.fixture
def image():
    rng = np.random.default_rng(1)

    def colour():
        return rng.random((*SIZE, 3)).astype(np.float16).astype(np.float32)

    names = ("direct", "indirect", "single_scatter", "multiple_scatter", "transmittance", "albedo")
    layers = {name: colour() for name in names}
    layers["normal"] = colour() * 2.0 - 1.0
    layers["depth"] = (1.0 + 1000.0 * rng.random(SIZE)).astype(np.float32)
    return Image(colour(), layers)


def test_compositing_programs_find_the_image_and_its_layers_by_name(image, tmp_path):
    image.save(tmp_path / "a.exr")
    planes = read_exr(tmp_path / "a.exr")
    for index, channel in enumerate("RGB"):  # the main image has no prefix
        np.testing.assert_array_equal(planes.pop(channel), image.radiance[..., index])
    for name, layer in image.layers.items():
        if name == "depth":
            np.testing.assert_array_equal(planes.pop("depth.Z"), layer)
            continue
        for index, channel in enumerate("XYZ" if name == "normal" else "RGB"):
            np.testing.assert_allclose(planes.pop(f"{name}.{channel}"), layer[..., index], 1e-3)
    assert not planes
