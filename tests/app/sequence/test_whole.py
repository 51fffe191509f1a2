"""Frames and videos that were cut off, or have holes, are not whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from airlight.app.sequence.whole import is_whole
from airlight.scene.image import Image
from airlight.scene.io.images import save_image


def image_of(height: int, width: int = 5) -> Image:
    pixels = np.random.default_rng(1).random((height, width, 3), dtype=np.float32)
    return Image(pixels, {"depth": pixels[..., 0]})


@pytest.mark.parametrize("ending", [".png", ".exr"])
@pytest.mark.parametrize("height", [1, 16, 17, 40])
def test_every_cut_is_found(tmp_path, ending, height):
    path = tmp_path / f"frame{ending}"
    save_image(image_of(height), path)
    whole = path.read_bytes()
    assert is_whole(path)
    for length in (*range(0, len(whole), 7), len(whole) - 1):
        path.write_bytes(whole[:length])
        assert not is_whole(path), length
    path.write_bytes(whole + b"\0")
    assert not is_whole(path)


@pytest.mark.parametrize("ending", [".png", ".exr"])
def test_a_hole_is_found(tmp_path, ending):
    path = tmp_path / f"frame{ending}"
    save_image(image_of(40), path)
    raw = bytearray(path.read_bytes())
    raw[len(raw) // 2 :] = bytes(len(raw) - len(raw) // 2)  # blocks that never reached the disk
    path.write_bytes(raw)
    assert not is_whole(path)


@pytest.mark.parametrize("ending", [".png", ".exr", ".mp4"])
@pytest.mark.parametrize("seed", range(20))
def test_no_bytes_are_too_strange(tmp_path, ending, seed):
    rng = np.random.default_rng(seed)
    path = tmp_path / f"frame{ending}"
    if ending == ".mp4":
        path.write_bytes(rng.bytes(200))
    else:
        save_image(image_of(17), path)
        raw = bytearray(path.read_bytes())
        for place in rng.integers(0, len(raw), 5):
            raw[place] = rng.integers(256)
        path.write_bytes(raw)
    assert is_whole(path) in (True, False)


def test_what_is_not_there_is_not_whole(tmp_path):
    assert not is_whole(tmp_path / "none.png")
    (tmp_path / "folder.png").mkdir()
    assert not is_whole(tmp_path / "folder.png")


def test_a_video_that_was_cut_off_is_not_whole(tmp_path):
    box = (16).to_bytes(4, "big") + b"ftyp" + bytes(8)
    long = (1).to_bytes(4, "big") + b"mdat" + (24).to_bytes(8, "big") + bytes(8)
    path = tmp_path / "a.mp4"
    path.write_bytes(box + long)
    assert is_whole(path)
    for length in range(len(box + long)):
        path.write_bytes((box + long)[:length])
        assert is_whole(path) == (length == len(box))


@pytest.mark.needs("av")
def test_a_real_video_is_whole(tmp_path):
    from airlight.app.sequence.video import video_comment, write_video

    frames = []
    for k in range(3):
        frames.append(tmp_path / f"{k}.png")
        save_image(image_of(16, 16), frames[-1])
    video = tmp_path / "a.mp4"
    write_video(frames, 10.0, video, "airlight sequence abc")
    assert is_whole(video)
    assert video_comment(video) == "airlight sequence abc"
    Path(video).write_bytes(video.read_bytes()[:-1])
    assert video_comment(video) == ""
