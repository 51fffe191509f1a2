"""Radiance HDR by hand, and what is encoded decoded again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene.io.rgbe import decode, encode

PATH = Path("a.hdr")
HEAD = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"


def test_hand_made_flat_pixels():
    raw = HEAD + b"\n-Y 1 +X 2\n" + bytes([128, 64, 0, 129, 255, 255, 255, 136])
    np.testing.assert_array_equal(decode(raw, PATH), [[[1, 0.5, 0], [255, 255, 255]]])


def test_hand_made_runs():
    """Each of the four planes of a 10-pixel line: a run of 7, then 3 as they are."""
    planes = b"".join(bytes([128 + 7, v, 3, v, v, v]) for v in (128, 0, 64, 129))
    raw = HEAD + b"\n-Y 2 +X 10\n" + (bytes([2, 2, 0, 10]) + planes) * 2
    np.testing.assert_array_equal(decode(raw, PATH), np.tile([1, 0, 0.5], (2, 10, 1)))


def test_rows_upwards_and_exposure():
    pixels = bytes([128, 128, 128, 129]) + bytes([0, 0, 0, 0])
    raw = HEAD + b"EXPOSURE=2\nEXPOSURE=0.25\n\n+Y 2 +X 1\n" + pixels
    np.testing.assert_array_equal(decode(raw, PATH)[:, 0, 0], [0, 2])


def test_what_is_encoded_comes_back_within_a_step():
    rng = np.random.default_rng(2)
    radiance = np.exp(rng.normal(scale=8, size=(7, 20, 3))).astype(np.float32)
    radiance[0, 0] = 0
    back = decode(encode(radiance), PATH)
    peak = radiance.max(axis=2, keepdims=True)
    assert np.all(np.abs(back - radiance) <= peak / 127)
    assert back[0, 0].tolist() == [0, 0, 0]


def test_negative_nan_and_infinite_values_do_no_harm():
    radiance = np.array([[[-1, np.nan, np.inf], [1e-40, 0, 0]]], dtype=np.float32)
    back = decode(encode(radiance), PATH)
    assert back[0, 0, 0] == back[0, 0, 1] == 0
    assert back[0, 0, 2] > 1e37
    assert back[0, 1].tolist() == [0, 0, 0]


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b"PNG", "not a Radiance HDR file"),
        (HEAD, "its HDR header has no size"),
        (HEAD + b"\n-Y 2 +X 2\n\0\0", "the file is truncated or damaged"),
        (HEAD + b"\n-Y 1 +X 10\n\x02\x02\x00\x0a\xff", "the file is truncated or damaged"),
        (HEAD + b"\n-Y 1 +X 10\n\x02\x02\x00\x0a\x00\x00", "the file is truncated or damaged"),
        (HEAD + b"\n-Y 99999 +X 99999\n", "is too large"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "XYZE"),
    ],
)
def test_damage(raw, message):
    with pytest.raises(SceneError) as error:
        decode(raw, PATH)
    assert str(error.value).startswith("a.hdr: ")
    assert message in str(error.value)


def test_the_cathedral(shared_data):
    """Its total light, by a reader that follows the format's text byte by byte."""
    raw = (shared_data / "environment" / "cathedral.hdr").read_bytes()
    pixels = decode(raw, PATH)
    body = raw.split(b"-Y 512 +X 1024\n", 1)[1]
    planes, at = [], 4
    for _ in range(4):
        plane: list[int] = []
        while len(plane) < 1024:
            n = body[at]
            plane += [body[at + 1]] * (n - 128) if n > 128 else body[at + 1 : at + 1 + n]
            at += 2 if n > 128 else 1 + n
        planes.append(plane)
    expected = [[m * 2.0 ** (e - 136) for m in rgb] for *rgb, e in zip(*planes, strict=True)]
    np.testing.assert_allclose(pixels[0], expected, rtol=1e-6)
