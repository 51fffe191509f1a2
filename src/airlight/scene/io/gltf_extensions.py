"""What extensions a glTF file asks for: read, warned of by name, or refused; and instances.

An extension that a file requires and that would leave nothing right is refused. Any other that
it uses and does not get is a warning that names it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...errors import SceneError
from ...maths.transforms import trs_matrix
from ..checks import F64
from .gltf_buffers import Buffers
from .gltf_compressed import DRACO, MESHOPT
from .gltf_json import Item
from .gltf_losses import extensions_held

INSTANCING = "EXT_mesh_gpu_instancing"
MOST_INSTANCES = 100_000
_SUPPORTED = {
    DRACO,
    INSTANCING,
    *MESHOPT,
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",  # says who made it
}
_LOST = {
    "KHR_node_visibility": "hidden nodes are shown",
    "MSFT_lod": "the finest level of detail is shown",
}


def check_extensions(document: Item) -> list[str]:
    """A warning for each extension that the file uses, or just has, and that is not read.

    Those of materials are named where a material has them. Raises SceneError for one that the
    file requires.
    """
    # What the file cannot be shown without.
    required = [str(item.value) for item in document.items("extensionsRequired")]
    for name in required:
        if not _is_read(name):
            raise SceneError(
                f"it needs the extension {name}, which airlight does not read",
                where=document.file,
                remedy="Export it without that extension.",
            )
    # Some exporters use extensions without listing them, so the whole document is searched.
    used = [str(item.value) for item in document.items("extensionsUsed")]
    used += extensions_held(document.value)
    return [
        f"{document.file}: the extension {name} is not read: "
        + _LOST.get(name, "what it adds is left out")
        for name in dict.fromkeys(used)
        if not _is_read(name)
    ]


def _is_read(name: str) -> bool:
    return name in _SUPPORTED or (name.startswith("KHR_materials_") and name not in _LOST)


def instances(node: Item, buffers: Buffers) -> Iterator[F64 | None]:
    """node_from_instance (4, 4) of every instance of a node's mesh; one None without instances.

    Source: Khronos, EXT_mesh_gpu_instancing: TRANSLATION, ROTATION and SCALE per instance.
    Raises SceneError.
    """
    extension = node.at("extensions", INSTANCING)
    # A node without instances is one, where it stands.
    if not extension.has("attributes"):
        yield None
        return
    attributes = extension.child("attributes")
    # What is there of the three parts of a placement.
    given: dict[str, F64] = {}
    for name, width in (("TRANSLATION", 3), ("ROTATION", 4), ("SCALE", 3)):
        if attributes.has(name):
            k = attributes.index(name, buffers.accessors, "accessors")
            # The bound is checked before any value is read.
            if buffers.accessors[k].integer("count", low=1) > MOST_INSTANCES:
                raise attributes.error(f"has more than {MOST_INSTANCES} instances")
            given[name] = buffers.array(attributes, name, width=width).astype(np.float64)
            if not np.isfinite(given[name]).all():
                raise attributes.child(name).error("holds NaN or infinite numbers")
    # All parts for the same number of instances.
    counts = {len(values) for values in given.values()}
    if len(counts) > 1:
        raise attributes.error(f"its attributes have {sorted(counts)} values")
    count = counts.pop() if counts else 0
    # Parts that are not given change nothing.
    shift = given.get("TRANSLATION", np.zeros((count, 3)))
    turn = given.get("ROTATION", np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))
    size = given.get("SCALE", np.ones((count, 3)))
    # A quaternion of length 0 is no turn, as in a node.
    for k in range(count):
        length = float(np.linalg.norm(turn[k]))
        unit = turn[k] / length if length > 0.0 else np.array([0.0, 0.0, 0.0, 1.0])
        yield trs_matrix(shift[k], unit, size[k])
