"""What Mitsuba's media are made of: extinction, albedo and phase functions, constants or grids."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from ...errors import SceneError
from ..checks import F32, F64, Bounds, Rgb
from .files import opened
from .mitsuba_nodes import Node
from .mitsuba_shapes import shape_matrix
from .mitsuba_textures import Source, rgb_of
from .volumes import read_volume

GRID: Bounds = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
"""Where Mitsuba's grids lie, unless they say otherwise."""


def extinction(node: Node, source: Source) -> tuple[F64 | F32, Bounds, F64 | None]:
    """sigma_t (3,) or (z, y, x, 3), m^-1, and the grid's box and placement."""
    scale = float(node.get("scale", 1.0))
    node.get("has_spectralextinction")
    if node.kind not in ("homogeneous", "heterogeneous"):
        raise SceneError(f"{node} is not read: use homogeneous or heterogeneous", where=source.path)
    child = node.child("sigma_t")
    if child is not None and child.kind == "gridvolume":
        values, bounds, matrix = _grid(child, source)
        return values * np.float32(scale), bounds, matrix
    if child is not None and child.kind == "constvolume" and node.kind == "heterogeneous":
        # It fills the unit cube where it stands, and what is outside of that is empty.
        values = np.full((2, 2, 2, 3), rgb_of(child.get("value", 1.0)), np.float32)
        return values * np.float32(scale), GRID, shape_matrix(child)
    if "sigma_s" in node.values or "sigma_a" in node.values:
        sigma_s, sigma_a = (np.array(rgb_of(node.get(k, 0.0))) for k in ("sigma_s", "sigma_a"))
        return scale * (sigma_s + sigma_a), GRID, None
    return scale * np.array(_constant(node, child, "sigma_t", 1.0, source)), GRID, None


def _constant(node: Node, child: Node | None, name: str, default: float, source: Source) -> Rgb:
    if child is None:
        return rgb_of(node.get(name, default))
    if child.kind == "constvolume":
        return rgb_of(child.get("value", 1.0))
    source.note(f"{child} as '{name}' of {node} is left out")
    return rgb_of(default)


def scattering_albedo(node: Node, source: Source, shape: tuple[int, ...] = ()) -> F64:
    """(3,), or a grid of the `shape` of that of sigma_t."""
    if "sigma_s" in node.values or "sigma_a" in node.values:
        sigma_s, sigma_a = (np.array(rgb_of(node.get(k, 0.0))) for k in ("sigma_s", "sigma_a"))
        return np.asarray(sigma_s / np.maximum(sigma_s + sigma_a, 1e-30))
    child = node.child("albedo")
    if child is not None and child.kind == "gridvolume":
        values, _, _ = _grid(child, source)
        if values.shape == shape:
            return np.clip(values, 0.0, 1.0).astype(np.float64)
        source.note(f"{node}: its albedo grid has other voxels than its sigma_t, and is its mean")
        return np.asarray(np.clip(values.reshape(-1, 3).mean(axis=0, dtype=np.float64), 0.0, 1.0))
    return np.asarray(np.clip(_constant(node, child, "albedo", 0.75, source), 0.0, 1.0))


def _grid(node: Node, source: Source) -> tuple[F32, Bounds, F64]:
    """Values (z, y, x, 3), own box and placement of a gridvolume."""
    path = source.file(node)
    for name, usual in (("filter_type", "trilinear"), ("wrap_mode", "clamp")):
        if node.get(name, usual) != usual:
            source.note(f"{node}: its {name} is read as {usual}")
    node.get("raw")
    # A grid of one channel stands for grey.
    count = _channel_count(path)
    channels = ("r", "g", "b") if count >= 3 else ("r",)
    grids = [read_volume(path, channels=c) for c in channels]
    values = np.stack([g.density for g in (grids if count >= 3 else grids * 3)], axis=-1)
    bounds = grids[0].bounds if node.get("use_grid_bbox", False) else GRID
    return values, bounds, shape_matrix(node)


def _channel_count(path: Path) -> int:
    """As a .vol file's header has it; 1 for anything else, which read_volume will judge."""
    with opened(path) as stream:
        header = stream.read(24)
    return int(struct.unpack("<i", header[20:24])[0]) if len(header) == 24 else 1


def phase_of(
    phase: Node | None, source: Source, shape: tuple[int, ...], *, is_alone: bool
) -> float | F32:
    """The mean cosine; by voxel where a medium that `is_alone` mixes two by a grid of `shape`."""
    if phase is None or phase.kind != "blendphase" or not is_alone:
        return mean_cosine_of(phase, source)
    parts, weight = phase.all("phase"), phase.child("weight")
    if len(parts) != 2 or weight is None or weight.kind != "gridvolume":
        return mean_cosine_of(phase, source)
    values, _, _ = _grid(weight, source)
    if values.shape != shape:
        return mean_cosine_of(phase, source)
    first, second = (phase_of(part, source, shape, is_alone=True) for part in parts)
    return np.asarray((1.0 - values) * first + values * second, np.float32)


def mean_cosine_of(phase: Node | None, source: Source) -> float:
    """g of a phase function; 0, and a note, for one that is not read."""
    if phase is None or phase.kind == "isotropic":
        return 0.0
    if phase.kind == "hg":
        return float(phase.get("g", 0.8))
    if phase.kind == "blendphase":
        parts = phase.all("phase")
        phase.read.update(phase.values)
        if len(parts) == 2 and parts[1].name == "phase_1":
            # As written by reference/mitsuba_media.py: the medium's, then the volume's own.
            mean_cosine_of(parts[0], source)
            return mean_cosine_of(parts[1], source)
    source.note(f"{phase} is read as isotropic")
    return 0.0
