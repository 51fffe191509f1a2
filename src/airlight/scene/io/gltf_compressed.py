"""Compressed meshes of glTF: meshopt's buffer views, and Draco's primitives.

Source: Khronos, EXT_meshopt_compression and KHR_draco_mesh_compression. Draco is decoded by the
package DracoPy, the extra `gltf`.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SceneError
from . import meshopt
from .gltf_json import Item

DRACO = "KHR_draco_mesh_compression"
MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_MOST_BYTES = 2**31
_MOST_PER_BYTE = 512
"""Bytes decoded from each compressed one: a block of zeros takes 1/64 of a byte a value."""


def meshopt_extension(view: Item) -> Item | None:
    """What a buffer view says of its compressed form, where it has one."""
    for name in MESHOPT:
        if view.child("extensions").has(name):
            return view.at("extensions", name)
    return None


def decoded_view(extension: Item, packed: bytes) -> bytes:
    """The bytes of a buffer view from its compressed form. Raises SceneError."""
    # What it claims to hold has to be in proportion to its bytes.
    count, stride = extension.integer("count", low=1), extension.integer("byteStride", low=1)
    if count * stride > min(_MOST_BYTES, max(len(packed), 64) * _MOST_PER_BYTE):
        raise extension.error(
            f"{count} elements of {stride} bytes are too many for {len(packed)} compressed bytes"
        )
    mode, name = extension.text("mode"), extension.text("filter", "NONE")
    try:
        # Rows of vertices, whose filter packs directions and numbers into integers.
        if mode == "ATTRIBUTES":
            rows = meshopt.decode_attributes(packed, count, stride)
            return meshopt.unfiltered(rows, name).tobytes()
        if mode not in ("TRIANGLES", "INDICES"):
            raise meshopt.MeshoptError(f"the mode '{mode}' is unknown")
        # Indices of vertices, two or four bytes each.
        decode = meshopt.decode_triangles if mode == "TRIANGLES" else meshopt.decode_indices
        indices = decode(packed, count)
        if stride not in (2, 4) or (stride == 2 and indices.max() > 0xFFFF):
            raise meshopt.MeshoptError(f"its indices do not fit into byteStride {stride}")
        return indices.astype("<u2" if stride == 2 else "<u4").tobytes()
    except meshopt.MeshoptError as error:
        raise extension.error(
            f"the meshopt stream cannot be decoded: {error}", "Export it again."
        ) from None


def decoded_primitive(
    extension: Item, packed: bytes
) -> tuple[NDArray[np.uint32], dict[str, NDArray[Any]]]:
    """Triangle corners (T, 3) and attributes (V, n) by name, of a primitive's Draco data.

    Raises SceneError where it is damaged, lacks what the file says it holds, or DracoPy is not
    installed.
    """
    # The connectivity and all attributes come from one stream.
    mesh = _draco_mesh(extension, packed)
    # The extension maps names to Draco's own ids, which are no indices.
    found: dict[str, NDArray[Any]] = {}
    attributes = extension.child("attributes")
    by_id = {a["unique_id"]: a["data"] for a in mesh.attributes}
    names = attributes.keys()
    for name in names:
        wanted = attributes.integer(name)
        if wanted not in by_id:
            raise attributes.child(name).error(f"its Draco data have no attribute {wanted}")
        values = np.asarray(by_id[wanted])
        found[name] = values.reshape(len(values), -1)
    return np.asarray(mesh.faces, dtype=np.uint32).reshape(-1, 3), found


def has_draco() -> bool:
    """Whether the package that decodes Draco is installed."""
    return find_spec("DracoPy") is not None


def _draco_mesh(extension: Item, packed: bytes) -> Any:
    """DracoPy's mesh, its errors turned into ours."""
    if not has_draco():
        raise SceneError(
            f"{extension.place}: meshes compressed with Draco need the package DracoPy",
            where=extension.file,
            remedy="Run: pip install 'airlight[gltf]'; or export it without compression.",
        )
    import DracoPy

    try:
        mesh = DracoPy.decode(packed)
    except Exception as error:  # of several families, all for damaged data
        raise extension.error(
            f"the Draco data cannot be decoded: {error}", "Export it again."
        ) from None
    if getattr(mesh, "faces", None) is None:
        raise extension.error("its Draco data hold points, not triangles")
    return mesh
