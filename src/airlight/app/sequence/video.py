"""Frames as one MP4: H.264, 4:2:0, BT.709 of limited range, which every player knows."""

from __future__ import annotations

import importlib.util
import io
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from ...errors import OutputError, SceneError, SettingsError
from ...scene.io.files import read_bytes, regular_file
from ...scene.io.ledger import own_files
from ...scene.io.writing import whole_file
from .whole import is_whole

VIDEO_SUFFIXES = (".mp4",)
_QUALITY = {"crf": "16", "preset": "medium"}
_BT709, _LIMITED = 1, 1  # ITU-T H.273, tables 2 to 4, and FFmpeg's AVCOL_RANGE_MPEG
_LARGEST_RATE_PART = 100_000


def check_video() -> None:
    """Raise SettingsError where videos cannot be written."""
    if importlib.util.find_spec("av") is None:
        raise SettingsError(
            "videos need the package 'av'",
            remedy="pip install 'airlight[video]', or give a folder for frames.",
        )


def write_video(
    frames: Sequence[Path],
    fps: float,
    path: Path,
    comment: str,
    report: Callable[[float], None] = lambda share: None,
) -> None:
    """Write `frames`, images of one size, to `path`, whole or not at all.

    `comment` is kept in it; `report(share)` is called as it goes. Raises OutputError.
    """
    import av

    with whole_file(path) as part:
        try:
            with av.open(str(part), "w", options={"movflags": "faststart"}) as container:
                container.metadata["comment"] = comment
                _encode(container, frames, fps, report)
        except av.FFmpegError as error:
            raise OutputError(
                f"the video cannot be written ({error.strerror or error})",
                where=path,
                remedy="The frames are kept; check the free space, and go on by --resume.",
            ) from None


def video_comment(path: Path) -> str:
    """What `write_video` kept in a video; empty where there is none, or not all of it."""
    import av

    # A video that was cut off may hold a comment and lack frames.
    if not is_whole(path):
        return ""
    try:
        with own_files(), av.open(str(regular_file(path))) as container:
            return str(container.metadata.get("comment", ""))
    except (av.FFmpegError, OSError, SceneError):
        return ""


def _encode(
    container: Any, frames: Sequence[Path], fps: float, report: Callable[[float], None]
) -> None:
    import av

    rate = Fraction(fps).limit_denominator(_LARGEST_RATE_PART)
    # H.264 in Rec.709 with limited range and halved chroma: what browsers and players expect.
    stream = container.add_stream("libx264", rate=rate, options=_QUALITY)
    # The first frame decides the size.
    first = _even(frames[0])
    stream.height, stream.width = first.shape[:2]
    stream.pix_fmt = "yuv420p"
    context = stream.codec_context
    context.colorspace = context.color_primaries = context.color_trc = _BT709
    context.color_range = _LIMITED
    # Each frame has its own time stamp, so that the rate may be a fraction.
    for index, file in enumerate(frames):
        # The first frame has been read for its size.
        pixels = first if index == 0 else _even(file)
        if pixels.shape != first.shape:
            raise OutputError("has another size than the first frame", where=file)
        frame = av.VideoFrame.from_ndarray(pixels, format="rgb24")
        frame = frame.reformat(format="yuv420p", dst_colorspace=_BT709, dst_color_range=_LIMITED)
        frame.pts, frame.time_base = index, 1 / rate
        container.mux(stream.encode(frame))
        report((index + 1) / len(frames))
    # The encoder still holds frames; an end makes it give them.
    container.mux(stream.encode(None))


def _even(file: Path) -> NDArray[np.uint8]:
    """An image's pixels (H, W, 3), the last row and column doubled where a side is odd."""
    try:
        with PIL.Image.open(io.BytesIO(read_bytes(file))) as image:
            pixels = np.asarray(image.convert("RGB"))
    except (OSError, ValueError, SceneError) as error:
        reason = error.problem if isinstance(error, SceneError) else error
        raise OutputError(
            f"is not a whole image ({reason})",
            where=file,
            remedy="Delete it, and make it again by --resume.",
        ) from None
    # Halved chroma needs even sides.
    height, width = pixels.shape[:2]
    return np.pad(pixels, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
