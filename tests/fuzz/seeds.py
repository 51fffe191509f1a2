"""Tiny good files of every format, made by airlight's own writers, by NumPy and Pillow, or here."""

from __future__ import annotations

import io
import struct
import tempfile
import zlib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from scripts import script

TESTS = Path(__file__).parents[1]
GOOD = Path(__file__).parent / "good"
Files = dict[str, bytes]


@cache
def of_tests(name: str) -> Any:
    """A module of the tests that writes a format by hand, such as scene/io/test_nanovdb.py."""
    return script(TESTS / name)


def _saved(name: str, save: Any) -> bytes:
    """What `save(path)` writes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        save(path)
        return path.read_bytes()


# ---- Arrays and grids --------------------------------------------------------------------------


def npy(values: Any) -> bytes:
    """An .npy file."""
    stream = io.BytesIO()
    np.save(stream, np.asarray(values))
    return stream.getvalue()


def npz(*, packed: bool = False, **arrays: Any) -> bytes:
    """An .npz file."""
    stream = io.BytesIO()
    (np.savez_compressed if packed else np.savez)(stream, **arrays)
    return stream.getvalue()


def smoke(side: int = 4) -> np.ndarray:
    """Densities (side, side + 1, side + 2)."""
    shape = (side, side + 1, side + 2)
    return np.linspace(0.0, 1.0, int(np.prod(shape)), dtype=np.float32).reshape(shape)


def vol() -> bytes:
    """Mitsuba's grid volume."""
    z, y, x = smoke().shape
    header = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, x, y, z, 1, -1, 0, -1, 1, 2, 1)
    return header + smoke().tobytes()


def nvdb(*, packed: bool) -> bytes:
    """A NanoVDB grid of two leaves."""
    made = of_tests("scene/io/test_nanovdb.py")
    return bytes(made.nvdb_bytes(packed=packed))


def nvdb_repacked(buffer: bytes, whole: bytes) -> bytes:
    """The packed NanoVDB file `whole` with another buffer in its place."""
    made = of_tests("scene/io/test_nanovdb.py")
    at = whole.index(made.NAME) + len(made.NAME)
    body = struct.pack("<Q", 0) + zlib.compress(buffer)
    record = bytearray(whole[:at])
    struct.pack_into("<2Q", record, 16, len(buffer), len(body))
    return bytes(record) + body


def nvdb_buffer(whole: bytes) -> bytes:
    """What is packed in a NanoVDB file of one grid."""
    made = of_tests("scene/io/test_nanovdb.py")
    return zlib.decompress(whole[whole.index(made.NAME) + len(made.NAME) + 8 :])


def vdb() -> bytes:
    """An OpenVDB grid of one leaf."""
    made = of_tests("scene/io/test_openvdb.py")
    return bytes(made.vdb_bytes(made.COUNTED))


def light_field() -> bytes:
    """What `airlight export-lattice` writes: a lattice of eight cells and a volume."""
    from airlight.exports.light_field import LatticeLight, LightField, VolumeLight
    from airlight.exports.light_field_file import save_light_field

    smoke_light = np.ones((2, 2, 2, 3), np.float32)
    volume = VolumeLight(smoke_light, np.eye(4), (0.0, 0.0, 3.0))
    cells = LatticeLight(
        (0.0, 0.0, 0.0),
        0.5,
        np.zeros((4, 3)),
        np.ones((2, 2, 2, 3, 4), np.float32),
        np.ones((2, 2, 2, 6), np.float32),
        np.zeros((2, 2, 2, 3), np.float32),
    )
    field = LightField("pop", "smoke", (cells,), (volume,))
    return _saved("light.npz", lambda path: save_light_field(field, path))


# ---- Images ----------------------------------------------------------------------------------


def pixels(height: int = 6, width: int = 8) -> np.ndarray:
    """RGBA bytes (height, width, 4)."""
    return (np.arange(height * width * 4) * 5 % 256).astype(np.uint8).reshape(height, width, 4)


def image(kind: str, mode: str = "RGBA") -> bytes:
    """PNG or JPEG, by Pillow."""
    import PIL.Image

    stream = io.BytesIO()
    grey = "L" if mode == "I;16" else mode  # which Pillow makes of bytes of grey only
    PIL.Image.fromarray(pixels()).convert(grey).convert(mode).save(stream, format=kind)
    return stream.getvalue()


def png_chunks(raw: bytes) -> list[tuple[bytes, bytes]]:
    """(kind, content) of a PNG's chunks."""
    found, at = [], 8
    while at + 12 <= len(raw):
        size = int.from_bytes(raw[at : at + 4], "big")
        found.append((raw[at + 4 : at + 8], raw[at + 8 : at + 8 + size]))
        at += 12 + size
    return found


def png_of(chunks: list[tuple[bytes, bytes]]) -> bytes:
    """A PNG of chunks, with sums that are right."""
    out = b"\x89PNG\r\n\x1a\n"
    for kind, content in chunks:
        check = zlib.crc32(kind + content)
        out += struct.pack(">I", len(content)) + kind + content + struct.pack(">I", check)
    return out


def exr(*, layers: bool = True, half: bool = False) -> bytes:
    """An image of airlight's, with layers."""
    from airlight.scene.image import Image
    from airlight.scene.io.images import save_image

    rgb = (pixels()[..., :3] / 100.0).astype(np.float32)
    image = Image(rgb, {"direct": rgb, "depth": rgb[..., 0], "normal": rgb})
    precision = "half" if half else "float"
    return _saved("a.exr", lambda path: save_image(image, path, layers=layers, precision=precision))


def hdr(*, packed: bool = False) -> bytes:
    """A Radiance image; packed by scanlines where asked for."""
    from airlight.scene.io.rgbe import encode

    rgb = (pixels(4, 8)[..., :3] / 50.0).astype(np.float32)
    flat = encode(rgb)
    if not packed:
        return flat.replace(b"\n\n", b"\nEXPOSURE=2.0\n\n", 1)
    row = b"\x02\x02\x00\x08" + b"\x88\x80\x04\x01\x02\x03\x04\x84\x05\x88\x10\x88\x81"
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n" + row * 4


# ---- Meshes ------------------------------------------------------------------------------------

OBJ, MTL, PLY, STL = (
    (GOOD / f"thing.{ending}").read_bytes() for ending in ("obj", "mtl", "ply", "stl")
)
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.5)], "<f4")
TRIANGLES = np.array([(0, 1, 2), (0, 2, 3)], "<i4")


def ply(*, big: bool = False) -> bytes:
    """A binary PLY."""
    order, name = (">", "big") if big else ("<", "little")
    head = (
        f"ply\nformat binary_{name}_endian 1.0\nelement vertex 4\nproperty float x\n"
        "property float y\nproperty float z\nelement face 2\n"
        "property list uchar int vertex_indices\nend_header\n"
    ).encode()
    faces = b"".join(b"\3" + row.astype(f"{order}i4").tobytes() for row in TRIANGLES)
    return head + CORNERS.astype(f"{order}f4").tobytes() + faces


def stl() -> bytes:
    """A binary STL."""
    facets = b"".join(
        struct.pack("<3f", 0, 0, 1) + CORNERS[row].tobytes() + b"\0\0" for row in TRIANGLES
    )
    return bytes(80) + struct.pack("<I", len(TRIANGLES)) + facets
