"""KTX 2 images: what is refused without the package, and pixels of blocks of one colour with it."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io import ktx2
from airlight.scene.io.images import read_texture
from airlight.scene.io.ktx2 import IDENTIFIER, is_ktx2, read_ktx2

COLOURS = np.array([[(200, 100, 50, 255), (0, 255, 7, 128)], [(9, 9, 9, 0), (255, 0, 1, 64)]])


def packed(colours: np.ndarray = COLOURS, faces: int = 1, vulkan_format: int = 0) -> bytes:
    """A UASTC file of 4 x 4 blocks of one colour each: mode 8 (five bits, 23), then RGBA."""
    blocks = b"".join(
        (23 | int.from_bytes(bytes(colour.tolist()), "little") << 5).to_bytes(16, "little")
        for colour in colours.reshape(-1, 4)
    )
    height, width = (4 * side for side in colours.shape[:2])
    described = struct.pack("<II2H8B8B", 44, 0, 2, 40, 166, 1, 2, 0, 3, 3, 0, 0, 16, *[0] * 7)
    described += struct.pack("<H6BII", 0, 127, 3, 0, 0, 0, 0, 0, 0xFFFFFFFF)
    at = len(IDENTIFIER) + 36 + 32 + 24
    first = (at + len(described) + 15) // 16 * 16
    head = IDENTIFIER + struct.pack("<9I", vulkan_format, 1, width, height, 0, 0, faces, 1, 0)
    head += struct.pack("<4I2Q", at, len(described), 0, 0, 0, 0)
    head += struct.pack("<3Q", first, len(blocks), len(blocks))
    return (head + described).ljust(first, b"\0") + blocks


@pytest.mark.needs("opengl_basisu")
def test_blocks_have_their_colours() -> None:
    assert is_ktx2(packed())
    texture = read_texture(packed(), is_srgb=True)
    np.testing.assert_array_equal(texture.pixels, COLOURS.repeat(4, axis=0).repeat(4, axis=1))


@pytest.mark.needs("opengl_basisu")
def test_damaged_data_are_refused() -> None:
    whole = packed()
    for length in (len(whole) - 1, len(whole) // 2, 60):
        with pytest.raises(SceneError):
            read_ktx2(whole[:length], "it")


@pytest.mark.parametrize(
    ("raw", "words"),
    [
        (IDENTIFIER, "ends in its header"),
        (packed(vulkan_format=37), "not packed by Basis Universal"),
        (packed(faces=6), "a volume, an array or a cube"),
        (packed()[:20] + struct.pack("<2I", 60000, 60000) + packed()[28:], "too large"),
    ],
)
def test_what_is_no_such_image_is_refused(raw: bytes, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        read_ktx2(raw, "it")


def test_without_the_package_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ktx2, "has_transcoder", lambda: False)
    with pytest.raises(SceneError, match="opengl-basisu") as error:
        read_ktx2(packed(), "it")
    assert "airlight[gltf]" in str(error.value)
