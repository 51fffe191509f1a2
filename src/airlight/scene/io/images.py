"""Image files <-> textures, radiance maps and rendered images.

Textures are 8-bit and keep their encoding. Radiance is linear float32. An image is written
by its ending: EXR (linear, layers; exr.py), HDR (linear; rgbe.py), PNG and JPEG (tone mapped).
"""

from __future__ import annotations

import functools
import io
import warnings as python_warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import numpy as np
import PIL.Image
from numpy.typing import NDArray

from ...errors import AirlightError, OutputError, SceneError, within_memory
from ...maths.chunks import chunks
from ...maths.colour import srgb_decode
from ..checks import F32
from ..image import Image
from ..material import Texture
from . import exr, rgbe
from .files import naming, read_bytes
from .image_sizes import MAX_TEXTURE_PIXELS, check_size
from .ktx2 import is_ktx2, read_ktx2
from .writing import whole_file

_BAND_ROWS = 256
_BY_PROGRAMS = ("EPS", "WMF", "STUB", "BUFR", "GRIB", "HDF5")
IMAGE_SUFFIXES = (".exr", ".hdr", ".png", ".jpg", ".jpeg")


def read_texture(data: Path | bytes, *, is_srgb: bool, source: str = "") -> Texture:
    """An 8-bit texture from a file or its bytes: PNG, JPEG, KTX 2 and whatever else Pillow reads.

    Palettes, grey, 16-bit and CMYK images become RGBA. `source` is what messages and the
    texture call it; the path where it is left out. Raises SceneError.
    """
    name = source or (str(data) if isinstance(data, Path) else "an embedded image")
    raw = read_bytes(data) if isinstance(data, Path) else data
    # Pillow does not read KTX 2.
    if is_ktx2(raw):
        return Texture(pixels=read_ktx2(raw, name), is_srgb=is_srgb, source=name)
    image = _opened(raw, name)
    with _fitting(image.size, name):
        return Texture(pixels=_rgba(image), is_srgb=is_srgb, source=name)


def _opened(raw: bytes, name: str) -> PIL.Image.Image:
    """An unpacked image."""
    try:
        with python_warnings.catch_warnings():
            # Our own limit, checked before any pixel is unpacked, stands in for Pillow's.
            python_warnings.simplefilter("ignore", PIL.Image.DecompressionBombWarning)
            image = PIL.Image.open(io.BytesIO(raw), formats=_formats())
            check_size(image.width, image.height, len(raw), name)
            with _fitting(image.size, name):
                image.load()
                return image
    except AirlightError:
        raise
    except PIL.Image.DecompressionBombError:
        raise SceneError(
            "image has too many pixels",
            where=name,
            remedy=f"Scale it to at most {MAX_TEXTURE_PIXELS} pixels.",
        ) from None
    except Exception as error:  # Pillow's decoders raise whatever comes to hand
        raise SceneError(f"not a readable image ({error})", where=name) from None


@contextmanager
def _fitting(size: tuple[int, int], name: object) -> Iterator[None]:
    """Memory that runs out while an image of `size`, pixels, is handled becomes a SceneError."""
    what = f"its image of {size[0]} x {size[1]} pixels"
    with within_memory(what, where=name, remedy="Scale it down.", kind=SceneError):
        yield


@functools.cache
def _formats() -> tuple[str, ...]:
    """What Pillow reads by itself. It hands others to programs, such as PostScript to one."""
    PIL.Image.init()
    return tuple(name for name in PIL.Image.ID if name not in _BY_PROGRAMS)


def _rgba(image: PIL.Image.Image) -> NDArray[np.uint8]:
    """RGBA pixels (H, W, 4), top row first."""
    if image.mode.startswith("I") or image.mode == "F":
        values = np.asarray(image, dtype=np.float64)
        # Pillow's wide grey modes hold 16 bits, or 0 to 1 where they are float.
        eight = values * 255.0 if image.mode == "F" else values / 257.0
        grey = np.clip(np.rint(np.nan_to_num(eight)), 0, 255).astype(np.uint8)
        return np.stack([grey, grey, grey, np.full_like(grey, 255)], axis=-1)
    return np.array(image.convert("RGBA"))


def read_radiance(path: Path, warnings: list[str] | None = None) -> F32:
    """Linear Rec.709 radiance (H, W, 3) float32 from EXR, HDR or any 8-bit image.

    An 8-bit image is decoded from sRGB; that, and infinite pixels cut to 65504, is said in
    `warnings`. Raises SceneError for unreadable files and NaN.
    """
    said = warnings if warnings is not None else []
    # Files of radiance are linear; all others are 8 bits of sRGB, which end at white.
    suffix = path.suffix.lower()
    if suffix == ".exr":
        pixels = exr.read_rgb(path)
    elif suffix in (".hdr", ".pic", ".rgbe"):
        pixels = rgbe.decode(read_bytes(path), path)
    else:
        said.append(f"{path}: an 8-bit image used as light; it has no highlights")
        return _decoded(_opened(read_bytes(path), str(path)), path)
    # Extremes are finite where all pixels are: one pass in the usual case.
    if not np.isfinite(pixels.max(initial=0.0)) or not np.isfinite(pixels.min(initial=0.0)):
        if np.isnan(pixels).any():
            raise SceneError(f"{int(np.isnan(pixels).sum())} values are NaN", where=path)
        said.append(f"{path}: infinite pixels are cut to 65504")
        return np.clip(pixels, 0.0, 65504.0)
    return pixels


def _decoded(image: PIL.Image.Image, path: Path) -> F32:
    """Linear pixels (H, W, 3) of an image whose values are sRGB.

    It goes a band of rows at a time: of a large image there is no other copy.
    """
    # All that 256 values can mean, once, instead of a power for each pixel.
    table = srgb_decode(np.arange(256) / 255.0).astype(np.float32)
    with _fitting(image.size, path):
        pixels = np.empty((image.height, image.width, 3), np.float32)
        for rows in chunks(image.height, _BAND_ROWS):
            band = image.crop((0, rows.start, image.width, rows.stop))
            pixels[rows] = table[_rgba(band)[..., :3]]
    return pixels


def save_image(
    image: Image, path: Path, *, layers: bool = True, precision: Literal["float", "half"] = "float"
) -> None:
    """Write an image; its format is its ending's. It appears whole or not at all.

    EXR holds linear radiance and, with `layers`, every layer as named channels; `precision`
    "half" halves its colours (depth stays float). HDR is linear; PNG and JPEG are tone mapped
    with the image's exposure and curve, and dithered by half a code value. Raises OutputError with
    a remedy.
    """
    suffix = path.suffix.lower()
    if suffix not in IMAGE_SUFFIXES:
        raise OutputError(
            f"cannot write an image that ends in '{path.suffix}'",
            where=path,
            remedy=f"End its name in one of {', '.join(IMAGE_SUFFIXES)}.",
        )
    # Float formats keep radiance, the others what is displayed.
    with whole_file(path) as part:
        if suffix == ".exr":
            exr.write(image, part, layers=layers, half=precision == "half")
        elif suffix == ".hdr":
            part.write_bytes(rgbe.encode(image.radiance))
        else:
            _write_display(image, part, suffix)


def _write_display(image: Image, path: Path, suffix: str) -> None:
    from ...maths.tone import display_srgb8

    try:
        pixels = display_srgb8(
            image.radiance, image.exposure_stops, image.tone_map, lut=image.lut, dither=True
        )
    except ValueError as error:
        raise OutputError(str(error), where=path) from None
    # Level 4 of deflate takes a third of the time of the default, 6, for a file 4 % larger.
    png: dict[str, Any] = {"compress_level": 4}
    options = png if suffix == ".png" else {"quality": 95, "subsampling": 0}
    PIL.Image.fromarray(pixels).save(path, **options)


def load_image(path: Path) -> Image:
    """Read an image back: EXR with its layers as written by `save_image`, or any image.

    Raises SceneError.
    """
    with naming(path):
        if path.suffix.lower() == ".exr":
            return exr.read(path)
        return Image(radiance=read_radiance(path))
