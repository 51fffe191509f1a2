"""Hierarchies of large meshes, cached on disk by the boxes that they were built over."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .. import env
from ..errors import AirlightError
from ..scene.checks import F32
from ..scene.fingerprint import array_digest
from ..scene.io.ledger import own_files
from ..scene.io.numpy_files import opened_npz
from ..scene.io.writing import keep
from .hierarchy import LEAF, Hierarchy, build, leaf_items

WORTH_CACHING = 20_000
"""Triangles from which reading a file is quicker than building: 50 ms."""
_VERSION = 2  # of `build`: what other versions made is not read


def built(low: F32, high: F32) -> Hierarchy:
    """`build`, from the cache where there is one; a cache that cannot be written changes nothing.

    Raises SettingsError where the cache folder's name leads nowhere.
    """
    # Small meshes are built in less time than a file is read.
    if len(low) < WORTH_CACHING:
        return build(low, high)
    # By the boxes alone: the same mesh in another file has the same hierarchy.
    name = array_digest(np.array(_VERSION), low, high).hex()
    path = env.cache_folder() / "hierarchies" / f"{name}.npz"
    found = _read(path, len(low))
    if found is None:
        found = build(low, high)
        stored: dict[str, Any] = {
            "order": found.order.astype(np.uint32),
            "children": found.children,
            "axes": found.axes.astype(np.uint8),
            "levels": np.array(found.levels),
        }
        keep(path, "a hierarchy", lambda part: np.savez(part, **stored))
    return found


def _read(path: Path, count: int) -> Hierarchy | None:
    """The hierarchy in a file over `count` items; None where there is none that is whole."""
    # A damaged file is as good as none.
    try:
        with own_files(), opened_npz(path) as file:
            order, children = file.array("order").astype(np.int64), file.array("children")
            axes, levels = file.array("axes").astype(np.uint32), file.array("levels").tolist()
    except (AirlightError, ValueError):
        return None
    if not _is_whole(order, children, axes, levels, count):
        return None
    return Hierarchy(order, children, axes, tuple(levels))


def _is_whole(order: Any, children: Any, axes: Any, levels: list[int], count: int) -> bool:
    """Whether each item is in one leaf and each node below one of the level before it."""
    # Arrays of the types and sizes that belong together.
    if children.dtype != np.uint32 or children.shape != (len(axes), 4) or order.shape != (count,):
        return False
    if levels[0] != 0 or levels[-1] != len(children) or len(levels) < 2:
        return False
    # What leaves hold, and what nodes are below others.
    flat = children.ravel()
    leaves = flat[flat >= LEAF]
    nodes = np.sort(flat[(flat > 0) & (flat < LEAF)])
    firsts, counts = leaf_items(leaves)
    by_first = np.argsort(firsts)
    ends = np.cumsum(counts[by_first])

    # Leaves cover all items once, and nodes but the root hang below one node each.
    return bool(
        np.array_equal(np.sort(order), np.arange(count))
        and np.array_equal(nodes, np.arange(1, len(children)))
        and np.array_equal(firsts[by_first], ends - counts[by_first])
        and (ends[-1] if len(ends) else 0) == count
    )
