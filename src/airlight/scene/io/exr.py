"""OpenEXR with named layers, as compositing programs expect them.

Channel names: R, G, B are the image; `direct.R`, `direct.G`, `direct.B` a colour layer;
`normal.X`, `.Y`, `.Z` a vector; `depth.Z` depth; `name.Y` any other scalar. ZIP compression.
Exposure, tone curve and statistics travel in the attributes `airlight_exposure_stops`,
`airlight_tone_map` and `airlight_stats` (JSON).
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

from ...errors import SceneError
from ..checks import F32
from ..image import Image
from .files import read_bytes
from .image_sizes import check_size

VECTOR_LAYERS = ("normal",)
FLOAT_LAYERS = ("depth", "position")
"""Never stored as half: 11 bits are millimetres at a metre and metres at a kilometre."""


def write(image: Image, path: Path, *, layers: bool, half: bool) -> None:
    """Write the image, and with `layers` its layers; colours as half where `half`."""
    # The image's own channels have no prefix, which every program takes for what to show.
    channels = _named(image.radiance, "", half)
    if layers:
        for name, pixels in image.layers.items():
            channels.update(_named(pixels, name, half and name not in FLOAT_LAYERS))
    # OpenEXR keeps attributes that it does not know, so that a reload looks as it was saved.
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "airlight_exposure_stops": float(image.exposure_stops),
        "airlight_tone_map": image.tone_map,
        "airlight_stats": json.dumps(dict(image.stats), default=str),
    }
    OpenEXR.File(header, channels).write(str(path))


def _named(pixels: F32, layer: str, half: bool) -> dict[str, Any]:
    """Channel name -> (H, W) array."""
    if pixels.ndim == 2:
        names = ["Z" if layer == "depth" else "Y"]
    else:
        names = list("XYZ" if layer in VECTOR_LAYERS else "RGB")
    planes = pixels.reshape(*pixels.shape[:2], len(names))
    if half:
        # Half ends at 65504; an infinite pixel would spread through every filter.
        planes = np.clip(planes, -65504.0, 65504.0).astype(np.float16)
    prefix = f"{layer}." if layer else ""
    return {prefix + name: np.ascontiguousarray(planes[..., k]) for k, name in enumerate(names)}


def read(path: Path) -> Image:
    """An image with its layers. Raises SceneError."""
    planes, header = _planes(read_bytes(path), path)
    # Without colours there is nothing to show; other layers alone make no image.
    radiance = _stacked(planes, "RGB")
    if radiance is None:
        raise SceneError(f"it has no R, G, B channels, only {_listed(planes)}", where=path)
    names = dict.fromkeys(name.rpartition(".")[0] for name in planes if "." in name)
    layers = {name: layer for name in names if (layer := _layer(planes, name)) is not None}
    return Image(
        radiance=radiance,
        layers=layers,
        **_attributes(header, path),
    )


def _attributes(header: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """What our own attributes say; those that are not there are as in a new image."""
    try:
        return {
            "exposure_stops": float(header.get("airlight_exposure_stops", 0.0)),
            "tone_map": str(header.get("airlight_tone_map", "agx")),
            "stats": dict(json.loads(header.get("airlight_stats", "{}"))),
        }
    except (TypeError, ValueError, RecursionError) as error:
        raise SceneError(f"its airlight attributes are damaged ({error})", where=path) from None


def _layer(planes: Mapping[str, F32], name: str) -> F32 | None:
    for channels in ("RGB", "XYZ"):
        stacked = _stacked(planes, channels, f"{name}.")
        if stacked is not None:
            return stacked
    for channel in "YZ":
        if f"{name}.{channel}" in planes:
            return planes[f"{name}.{channel}"]
    return None


def read_rgb(path: Path) -> F32:
    """The colours of any EXR, (H, W, 3) float32; grey from a lone Y. Raises SceneError."""
    planes, _ = _planes(read_bytes(path), path)
    rgb = _stacked(planes, "RGB")
    if rgb is not None:
        return rgb
    if "Y" in planes:
        return np.repeat(planes["Y"][..., None], 3, axis=2)
    raise SceneError(f"it has no R, G, B channels, only {_listed(planes)}", where=path)


def _planes(raw: bytes, path: Path) -> tuple[dict[str, F32], Mapping[str, Any]]:
    """Every channel of the first part as (H, W) float32, and the header."""
    try:
        # Sizes are checked before any pixel is unpacked.
        with OpenEXR.File(io.BytesIO(raw), separate_channels=True, header_only=True) as file:
            _check_sizes([part.header for part in file.parts], len(raw), path)
        with OpenEXR.File(io.BytesIO(raw), separate_channels=True) as file:
            header = dict(file.header())
            planes = {
                str(name): np.array(channel.pixels, dtype=np.float32)
                for name, channel in file.channels().items()
            }
    except SceneError:
        raise
    except Exception as error:  # OpenEXR raises RuntimeError, ValueError and TypeError
        raise SceneError(f"not a readable EXR file ({error})", where=path) from None
    # One plane a channel, all alike: what an image is made of here.
    if len({plane.shape for plane in planes.values()}) > 1 or any(
        plane.ndim != 2 for plane in planes.values()
    ):
        raise SceneError("subsampled and deep EXR channels are not supported", where=path)
    return planes, header


def _check_sizes(headers: Sequence[Mapping[str, Any]], file_bytes: int, path: Path) -> None:
    """Raise SceneError for parts that unpack to more than the file's size bears out."""
    for header in headers:
        low, high = (np.asarray(corner, dtype=np.int64) for corner in header["dataWindow"])
        width, height = (int(n) for n in high - low + 1)
        layers = -(-len(header["channels"]) // 3)
        check_size(width, height, file_bytes, path, layers=max(layers, 1))


def _stacked(planes: Mapping[str, F32], channels: str, prefix: str = "") -> F32 | None:
    names = [prefix + channel for channel in channels]
    if not all(name in planes for name in names):
        return None
    return np.stack([planes[name] for name in names], axis=-1)


def _listed(planes: Mapping[str, F32]) -> str:
    return ", ".join(sorted(planes)) or "none"
