"""KTX 2 images as glTF packs textures (KHR_texture_basisu): ETC1S and UASTC, by opengl-basisu.

The package is Basis Universal's own transcoder, part of the extra `gltf`.
"""

from __future__ import annotations

import struct
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from .image_sizes import check_size

IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
# Format, type size, width, height, depth, layers, faces, levels, packing.
_HEADER = struct.Struct("<9I")


def is_ktx2(raw: bytes) -> bool:
    """Whether bytes are a KTX 2 file."""
    return raw.startswith(IDENTIFIER)


def has_transcoder() -> bool:
    """Whether the package that unpacks Basis Universal is installed."""
    return find_spec("opengl_basisu") is not None


def read_ktx2(raw: bytes, name: object) -> NDArray[np.uint8]:
    """RGBA pixels (H, W, 4) of a file's largest level, top row first.

    Raises SceneError where the file is damaged, is no image of two dimensions, holds no Basis
    Universal data, or the package is not installed.
    """
    # The identifier and the first fields, without which nothing can be said.
    if len(raw) < len(IDENTIFIER) + _HEADER.size:
        raise SceneError("the KTX 2 image ends in its header", where=name)
    # Only flat images that Basis Universal packed.
    fields = _HEADER.unpack_from(raw, len(IDENTIFIER))
    vulkan_format, width, height, depth, layers, faces = (fields[k] for k in (0, 2, 3, 4, 5, 6))
    if vulkan_format != 0:
        raise SceneError(
            "the KTX 2 image is not packed by Basis Universal",
            where=name,
            remedy="Pack it as ETC1S or UASTC, or save it as PNG.",
        )
    if depth or layers > 1 or faces != 1 or not (width and height):
        raise SceneError("the KTX 2 image is a volume, an array or a cube", where=name)
    # The size is the header's word: checked before anything is unpacked.
    check_size(width, height, len(raw), name)
    if not has_transcoder():
        raise SceneError(
            "KTX 2 images need the package opengl-basisu",
            where=name,
            remedy="Run: pip install 'airlight[gltf]'; or export the images as PNG or JPEG.",
        )
    import opengl_basisu

    # Its largest level.
    try:
        image = opengl_basisu.Texture(raw).transcode("rgba8")
    except opengl_basisu.BasisuError as error:
        raise SceneError(f"the KTX 2 image cannot be unpacked: {error}", where=name) from None
    return np.array(image.data, np.uint8)
