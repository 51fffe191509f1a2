"""The files beside a Mitsuba scene: meshes, images and density grids.

Nothing here needs Mitsuba itself: binary PLY, PNG, OpenEXR and Mitsuba's .vol are written
directly.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Hashable
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from ..scene.checks import F32, Bounds

_NAME = re.compile(r".+_\d{4,}\.(?:ply|png|exr|vol)")


class FileStore:
    """Writes files into `folder` and names them PREFIX/name; equal content once.

    `knows_airlight`: the scene is for our own child process, which has our reflection model.
    """

    def __init__(self, folder: Path, prefix: str, *, knows_airlight: bool = False) -> None:
        self.knows_airlight = knows_airlight
        self.folder = folder
        self.prefix = prefix
        self._names: dict[Hashable, str] = {}
        self._kept: dict[int, object] = {}
        self.bsdfs: dict[Hashable, Element] = {}
        self.meshes: list[str] = []  # names behind the numbers in ids

    def once(self, key: Hashable, stem: str, ending: str, write: Callable[[Path], None]) -> str:
        """The scene-relative name of the file for `key`, written on first request."""
        known = self._names.get(key)
        if known is None:
            name = f"{stem}_{len(self._names):04d}.{ending}"
            write(self.folder / name)
            known = self._names[key] = f"{self.prefix}/{name}"
        return known

    def identity(self, value: object) -> int:
        """id(value), with `value` kept alive so that the id stays its own."""
        self._kept[id(value)] = value
        return id(value)


def is_written(name: str, stem: str) -> bool:
    """Whether a file of this name could be from a FileStore of the scene STEM.xml."""
    return name == f"{stem}.xml" or _NAME.fullmatch(name) is not None


def write_ply(
    path: Path,
    positions: F32,
    indices: NDArray[np.uint32],
    *,
    normals: F32 | None = None,
    uvs: F32 | None = None,
    colors: F32 | None = None,
) -> None:
    """A little-endian binary PLY of triangles. `colors` (V, 3) become Mitsuba's vertex_color."""
    # Vertices interleaved, each with what the arrays hold of it, in the order of the header.
    names = ["x", "y", "z"] + ["nx", "ny", "nz"] * (normals is not None)
    names += ["u", "v"] * (uvs is not None) + ["r", "g", "b"] * (colors is not None)
    arrays = [a for a in (positions, normals, uvs, colors) if a is not None]
    vertices = np.ascontiguousarray(np.concatenate(arrays, axis=1), dtype="<f4")
    # Faces are lists in this format, each with its length before it.
    faces = np.empty(len(indices), dtype=[("count", "u1"), ("index", "<i4", 3)])
    faces["count"], faces["index"] = 3, indices

    # The header names every property in the order in which the bytes follow.
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {name}" for name in names]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    with path.open("wb") as file:
        file.write(("\n".join(header) + "\n").encode())
        file.write(vertices.tobytes())
        file.write(faces.tobytes())


def write_exr(path: Path, pixels: F32) -> None:
    """Linear float32 (H, W, 3) or (H, W), top row first."""
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    data = np.ascontiguousarray(pixels, dtype=np.float32)
    channels = {"RGB" if data.ndim == 3 else "Y": data}
    OpenEXR.File(header, channels).write(str(path))


def write_png(path: Path, pixels: NDArray[np.uint8]) -> None:
    """8 bits: (H, W, 3) or (H, W), top row first."""
    from PIL import Image

    Image.fromarray(np.ascontiguousarray(pixels)).save(path, compress_level=1)


def write_vol(path: Path, values: F32, bounds: Bounds) -> None:
    """Mitsuba's grid file, version 3: `values` (z, y, x) or (z, y, x, channel) float32."""
    # One channel is a grid with a last axis of one.
    grid = values[..., None] if values.ndim == 3 else values
    depth, height, width, channels = grid.shape

    # Size and channels, then the box that the grid fills, then x fastest.
    with path.open("wb") as file:
        file.write(b"VOL\x03" + struct.pack("<5i", 1, width, height, depth, channels))
        file.write(struct.pack("<6f", *bounds[0], *bounds[1]))
        file.write(np.ascontiguousarray(grid, dtype="<f4").tobytes())
