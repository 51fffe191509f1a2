"""Light fields as OpenVDB files: Blender, Houdini and compositing programs show them.

Source: the OpenVDB library's file format, version 224, packed by zip; `scene.io.openvdb_tree` reads
the same. All voxels of a lattice are active; places without light are left out with their blocks.
"""

from __future__ import annotations

import struct
import uuid
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..maths.arrays import F32, F64
from ..scene.io.writing import whole_file
from .light_field import LightField

MAGIC, VERSION, LIBRARY = 0x56444220, 224, (10, 0)
_ZIP, _ACTIVE_MASK = 1, 2
_LEAF, _LOWER, _UPPER = 8, 16, 32  # children of a node along a side; a leaf's are voxels
_LOWER_SIDE, _UPPER_SIDE = _LEAF * _LOWER, _LEAF * _LOWER * _UPPER
_INACTIVE_ARE_BACKGROUND = b"\0"


@dataclass(frozen=True, eq=False)
class VdbGrid:
    """A grid of numbers or vectors: `values` (z, y, x) or (z, y, x, 3) float32.

    Voxel centres lie at whole numbers of `world_from_index` (4, 4). `meaning` is a sentence of its
    metadata.
    """

    name: str
    values: F32
    world_from_index: F64
    meaning: str


def save_light_vdb(field: LightField, path: str | Path) -> None:
    """Write the light of a field as `path`, a .vdb. Raises OutputError.

    Each lattice gives `lattice0_mean_radiance`, what comes from all around, divided by 4 pi, and
    `lattice0_air` where media scatter; each volume of `pop` gives `volume0`, towards the camera.
    """
    with whole_file(Path(path)) as part:
        part.write_bytes(vdb_bytes(light_grids(field), {"scene": field.scene}))


def light_grids(field: LightField) -> list[VdbGrid]:
    """What `save_light_vdb` writes."""
    unit = "W m^-2 sr^-1, linear Rec.709"
    grids = []
    for k, cells in enumerate(field.lattices):
        # Voxel centres lie in the middle of cells.
        placed = np.eye(4)
        placed[:3, :3] = cells.axes.T * cells.cell
        placed[:3, 3] = cells.axes.T @ (np.array(cells.origin) + 0.5 * cells.cell)
        text = f"mean radiance of bounced and scattered light, {unit}"

        # The constant term is the mean over all directions.
        mean = np.maximum(cells.surfaces[..., 0], 0.0)
        grids.append(VdbGrid(f"lattice{k}_mean_radiance", mean, placed, text))
        if cells.air is not None:
            text = f"mean radiance that air scatters, times sigma_s, {unit}"
            air = np.maximum(cells.air[..., 0], 0.0)
            grids.append(VdbGrid(f"lattice{k}_air", air, placed, text))
    for k, volume in enumerate(field.volumes):
        # Cells of the unit cube; the centre of the first lies half a cell from its corner.
        count = np.array(volume.radiance.shape[2::-1], np.float64)
        unit_from_index = np.diag([*(1.0 / count), 1.0])
        unit_from_index[:3, 3] = 0.5 / count
        placed = volume.world_from_unit @ unit_from_index
        text = f"radiance scattered towards the camera, times sigma_s, {unit}"
        grids.append(VdbGrid(f"volume{k}", volume.radiance, placed, text))
    return grids


def vdb_bytes(grids: list[VdbGrid], about: dict[str, str]) -> bytes:
    """A whole file of grids, with metadata of its own."""
    out = bytearray(struct.pack("<qIIIB", MAGIC, VERSION, *LIBRARY, 1))
    # The identity is made of the content, so that the same light gives the same bytes.
    named = "".join(grid.name + str(zlib.crc32(grid.values.tobytes())) for grid in grids)
    out += str(uuid.uuid5(uuid.NAMESPACE_OID, named)).encode()
    out += _metadata({"creator": "airlight", **about})
    out += struct.pack("<I", len(grids))
    # Offsets of a grid's parts stand before it, and are known only behind it.
    for grid in grids:
        kind = "vec3s" if grid.values.ndim == 4 else "float"
        out += _text(grid.name) + _text(f"Tree_{kind}_5_4_3") + _text("")
        offsets_at = len(out)
        out += bytes(24)
        begin = len(out)
        head, blocks = _grid(grid)
        out += head + blocks
        struct.pack_into("<3q", out, offsets_at, begin, begin + len(head), len(out))
    return bytes(out)


def _grid(grid: VdbGrid) -> tuple[bytes, bytes]:
    """A grid up to its leaves' values, and those."""
    out = struct.pack("<I", _ZIP | _ACTIVE_MASK)
    out += _metadata({"name": grid.name, "class": "unknown", "comment": grid.meaning})
    # The library multiplies row vectors, hence the transposed matrix.
    out += _text("AffineMap") + np.ascontiguousarray(grid.world_from_index.T, "<f8").tobytes()
    values = grid.values if grid.values.ndim == 4 else grid.values[..., None]
    topology, blocks = _tree(np.ascontiguousarray(values.transpose(2, 1, 0, 3), "<f4"))
    return out + topology, blocks


def _tree(values: F32) -> tuple[bytes, bytes]:
    """The topology and the leaves' values of a tree that holds `values` (x, y, z, n) from 0 on."""
    # Padded to whole leaves; only voxels of the lattice itself are active.
    size, channels = np.array(values.shape[:3]), values.shape[3]
    leaf_count = -(-size // _LEAF)
    padded = np.zeros((*(leaf_count * _LEAF), channels), "<f4")
    padded[tuple(slice(0, n) for n in size)] = values
    active = np.zeros(padded.shape[:3], bool)
    active[tuple(slice(0, n) for n in size)] = True
    # Leaves as nodes of blocks, (x, y, z) blocks of (8, 8, 8) voxels; dark ones are left out.
    split = [n for pair in zip(leaf_count, (_LEAF,) * 3, strict=True) for n in pair]
    blocks = padded.reshape(*split, channels).transpose(0, 2, 4, 1, 3, 5, 6)
    masks = active.reshape(split).transpose(0, 2, 4, 1, 3, 5)
    is_lit: NDArray[np.bool_] = np.asarray(blocks.any(axis=(3, 4, 5, 6)))
    if not is_lit.any():
        is_lit[0, 0, 0] = True
    # Root, upper and lower nodes by number, leaves by mask; values follow in the same order.
    topology, stored = bytearray(), bytearray()
    topology += struct.pack("<I", 1) + bytes(4 * channels)  # one buffer; the background, 0
    roots = _children(np.argwhere(is_lit), _UPPER_SIDE // _LEAF)
    topology += struct.pack("<II", 0, len(roots))
    for root, below in roots:
        topology += struct.pack("<3i", *(root * _UPPER_SIDE))
        lowers = _children(below, _LOWER)
        topology += _node([node - root * _UPPER for node, _ in lowers], _UPPER)
        for lower, leaves in lowers:
            topology += _node(list(leaves - lower * _LOWER), _LOWER)
            for leaf in leaves:
                mask = masks[tuple(leaf)].ravel()
                bits = np.packbits(mask, bitorder="little").tobytes()
                topology += bits
                own = blocks[tuple(leaf)].reshape(-1, channels)[mask]
                stored += bits + _INACTIVE_ARE_BACKGROUND + _packed(own.tobytes())
    return bytes(topology), bytes(stored)


def _children(
    leaves: NDArray[np.int64], side: int
) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
    """Leaves (n, 3) by the nodes of `side` leaves that they lie in, in the tree's order."""
    nodes, belongs = np.unique(leaves // side, axis=0, return_inverse=True)
    return [(node, leaves[belongs.ravel() == k]) for k, node in enumerate(nodes)]


def _node(children: list[NDArray[np.int64]], side: int) -> bytes:
    """An inner node without tiles: its masks, and no values."""
    mask = np.zeros((side,) * 3, bool)
    mask[tuple(np.array(children).T)] = True
    bits = np.packbits(mask.ravel(), bitorder="little").tobytes()
    return bits + bytes(side**3 // 8) + _INACTIVE_ARE_BACKGROUND + _packed(b"")


def _packed(raw: bytes) -> bytes:
    """Behind its packed length, which is negative for what would not shrink."""
    small = zlib.compress(raw)
    if len(small) < len(raw):
        return struct.pack("<q", len(small)) + small
    return struct.pack("<q", -len(raw)) + raw


def _text(value: str) -> bytes:
    raw = value.encode()
    return struct.pack("<I", len(raw)) + raw


def _metadata(entries: dict[str, Any]) -> bytes:
    out = struct.pack("<I", len(entries))
    for name, value in entries.items():
        out += _text(name) + _text("string") + _text(str(value))
    return out
