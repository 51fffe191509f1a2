"""Mitsuba's media, and the shapes that hold them, as a medium and volumes.

Where media nest, Mitsuba's inner one stands alone and airlight's adds to the outer one: the
outer medium is taken off the inner coefficients.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import SceneError
from ...maths.transforms import triple
from ..checks import F32, F64, Bounds, Rgb
from ..coefficients import scale_density_tint
from ..medium import Medium
from ..volume import Volume
from .files import opened
from .mitsuba_nodes import Node
from .mitsuba_shapes import Placed, shape_geometries, shape_matrix
from .mitsuba_textures import Source, rgb_of
from .volumes import read_volume

UNIT: Bounds = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
# Mitsuba's grid fills [0, 1]^3.
GRID: Bounds = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


@dataclass(frozen=True, eq=False)
class Held:
    """A medium and where it is: the shape's kind and placement.

    `sigma_t` (3,) for a homogeneous one, else (z, y, x, 3) with its box and placement; then
    `albedo` and `g` may be grids of the same shape.
    """

    node: Node
    exterior: Node | None
    kind: str
    world_from_shape: F64
    extent: Bounds
    sigma_t: F64 | F32
    albedo: F64
    g: float | F32
    grid_bounds: Bounds = GRID
    world_from_grid: F64 | None = None

    @property
    def is_homogeneous(self) -> bool:
        """Whether its extinction is one triple, not a grid."""
        return self.sigma_t.ndim == 1

    @property
    def box(self) -> tuple[F64, F64] | None:
        """World corners, where the shape is an upright box."""
        linear = self.world_from_shape[:3, :3]
        if self.kind != "cube" or np.abs(linear - np.diag(np.diag(linear))).max() > 1e-9:
            return None
        ends = np.array(self.extent) * np.diag(linear) + self.world_from_shape[:3, 3]
        return ends.min(axis=0), ends.max(axis=0)


def held_medium(shape: Node, interior: Node, exterior: Node | None, source: Source) -> Held:
    """What the medium `interior` of a shape is, and where."""
    kind, matrix, extent = _region(shape, source)
    sigma_t, grid, world_from_grid = _extinction(interior, source)
    return Held(
        interior,
        exterior,
        kind,
        matrix,
        extent,
        sigma_t,
        _albedo(interior, source, sigma_t.shape),
        _phase(interior.first("phase"), source, sigma_t.shape, is_alone=exterior is None),
        grid,
        world_from_grid,
    )


def medium_and_volumes(
    held: list[Held], around_camera: Node | None, source: Source
) -> tuple[Medium | None, tuple[Volume, ...]]:
    """The scene's one homogeneous medium, and everything else as volumes."""
    air = _largest_box(held)
    medium: Medium | None = None
    if air is not None:
        low, high = (tuple(float(x) for x in corner) for corner in air.box or ())
        sigma_t, albedo, g = triple(air.sigma_t), triple(air.albedo), (air.g,) * 3
        medium = Medium(sigma_t, albedo, g, (low, high))  # type: ignore[arg-type]
    elif around_camera is not None and not any(h.node.id == around_camera.id for h in held):
        medium = _endless(around_camera, source)
    volumes = [_volume(h, air, source) for h in held if h is not air]
    return medium, tuple(v for v in volumes if v is not None)


def _largest_box(held: list[Held]) -> Held | None:
    boxes = [(h, h.box) for h in held if h.is_homogeneous]
    sizes = [(float(np.prod(box[1] - box[0])), h) for h, box in boxes if box is not None]
    return max(sizes, key=lambda entry: entry[0])[1] if sizes else None


def _endless(node: Node, source: Source) -> Medium | None:
    """The medium around the camera that no shape bounds: it fills the scene."""
    sigma_t, _, _ = _extinction(node, source)
    if sigma_t.ndim != 1:
        source.note(f"{node}: a grid around the camera that no shape bounds is left out")
        return None
    g = _mean_cosine(node.first("phase"), source)
    return Medium(triple(sigma_t), triple(_albedo(node, source)), (g,) * 3)


def _volume(held: Held, air: Held | None, source: Source) -> Volume | None:
    sigma_t, albedo, g = _without_medium(held, air, source)
    if float(sigma_t.max()) <= 0.0:
        return None
    # One density everywhere, in a box or a sphere.
    if held.is_homogeneous:
        assert isinstance(g, float)  # only a grid's phase functions are mixed by voxel
        return Volume(
            sigma_t=triple(sigma_t),
            albedo=triple(albedo),
            g=(g,) * 3,
            shape="sphere" if held.kind == "sphere" else "box",
            bounds=held.extent,
            world_from_volume=held.world_from_shape,
        )
    # A grid: its densities, and the coefficients of density 1.
    top, density, tint = scale_density_tint(np.asarray(sigma_t, dtype=np.float32))
    placed = held.world_from_grid
    is_one_albedo = albedo.ndim < 4
    return Volume(
        sigma_t=top,
        density=density,
        tint=tint,
        albedo=triple(albedo) if is_one_albedo else (1.0, 1.0, 1.0),
        albedo_grid=None if is_one_albedo else np.asarray(albedo, np.float32),
        g=(g,) * 3 if isinstance(g, float) else (0.0, 0.0, 0.0),
        g_grid=None if isinstance(g, float) else g,
        bounds=held.grid_bounds,
        world_from_volume=np.eye(4) if placed is None else placed,
    )


def _without_medium(
    held: Held, air: Held | None, source: Source
) -> tuple[F64 | F32, F64, float | F32]:
    """Coefficients less those of the medium around, where the shape lies in it."""
    if air is None or held.exterior is None or held.exterior.id != air.node.id:
        if air is not None and _lies_inside(held, air):
            source.note(f"{held.node} lies in the medium of the scene, whose extinction it adds to")
        return held.sigma_t, held.albedo, held.g
    # The medium around is in the file's coefficients; the rest is the volume's own.
    inner, outer = (np.asarray(h.sigma_t, dtype=np.float64) for h in (held, air))
    rest: F64 = inner - outer
    if rest.min() < -1e-4 * float(outer.max()):
        source.note(f"{held.node} is thinner than the medium around it, which cannot be said")
    sigma_t: F64 = np.maximum(rest, 0.0)
    # The albedo follows from the scattering of that rest, per voxel where it varies.
    scattered = inner * held.albedo - outer * air.albedo
    parts = (scattered, sigma_t)
    if held.albedo.ndim < 4:
        parts = tuple(part.reshape(-1, 3).sum(axis=0) for part in parts)
    albedo = np.clip(parts[0] / np.maximum(parts[1], 1e-30), 0.0, 1.0)
    if held.g != air.g:
        source.note(f"{held.node}: its g is taken as its own, the mix with the medium is left out")
    return sigma_t, albedo, held.g


def _lies_inside(held: Held, air: Held) -> bool:
    box = air.box
    centre = held.world_from_shape[:3, 3]
    return box is not None and bool((centre > box[0]).all() and (centre < box[1]).all())


def _region(shape: Node, source: Source) -> tuple[str, F64, Bounds]:
    """Kind, placement and own extent of a shape; the box around anything but cube and sphere."""
    matrix = shape_matrix(shape)
    # Shapes that volumes of ours have.
    if shape.kind == "cube":
        return "cube", matrix, UNIT
    if shape.kind == "sphere":
        radius = float(shape.get("radius", 1.0))
        c = np.array(shape.get("center", (0.0, 0.0, 0.0)))
        return "sphere", matrix, (triple(c - radius), triple(c + radius))
    # Of all others the box around them.
    parts: list[Placed] = shape_geometries(shape, source)
    if not parts:
        raise SceneError(f"{shape} holds a medium, but is not read", where=source.path)
    points = np.concatenate(
        [
            p.geometry.positions @ p.world_from_object[:3, :3].T + p.world_from_object[:3, 3]
            for p in parts
        ]
    )
    source.note(f"{shape}: its medium fills the box around it")
    return "cube", np.eye(4), (triple(points.min(axis=0)), triple(points.max(axis=0) + 1e-9))


def _extinction(node: Node, source: Source) -> tuple[F64 | F32, Bounds, F64 | None]:
    """sigma_t (3,) or (z, y, x, 3), m^-1, and the grid's box and placement."""
    scale = float(node.get("scale", 1.0))
    node.get("has_spectral_extinction")
    if node.kind not in ("homogeneous", "heterogeneous"):
        raise SceneError(f"{node} is not read: use homogeneous or heterogeneous", where=source.path)
    child = node.child("sigma_t")
    if child is not None and child.kind == "gridvolume":
        values, bounds, matrix = _grid(child, source)
        return values * np.float32(scale), bounds, matrix
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


def _albedo(node: Node, source: Source, shape: tuple[int, ...] = ()) -> F64:
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
    matrix = node.get("to_world")
    bounds = grids[0].bounds if node.get("use_grid_bbox", False) else GRID
    return values, bounds, np.eye(4) if matrix is None else np.asarray(matrix, np.float64)


def _channel_count(path: Path) -> int:
    """As a .vol file's header has it; 1 for anything else, which read_volume will judge."""
    with opened(path) as stream:
        header = stream.read(24)
    return int(struct.unpack("<i", header[20:24])[0]) if len(header) == 24 else 1


def _phase(
    phase: Node | None, source: Source, shape: tuple[int, ...], *, is_alone: bool
) -> float | F32:
    """The mean cosine; by voxel where a medium that `is_alone` mixes two by a grid of `shape`."""
    if phase is None or phase.kind != "blendphase" or not is_alone:
        return _mean_cosine(phase, source)
    parts, weight = phase.all("phase"), phase.child("weight")
    if len(parts) != 2 or weight is None or weight.kind != "gridvolume":
        return _mean_cosine(phase, source)
    values, _, _ = _grid(weight, source)
    if values.shape != shape:
        return _mean_cosine(phase, source)
    first, second = (_phase(part, source, shape, is_alone=True) for part in parts)
    return np.asarray((1.0 - values) * first + values * second, np.float32)


def _mean_cosine(phase: Node | None, source: Source) -> float:
    if phase is None or phase.kind == "isotropic":
        return 0.0
    if phase.kind == "hg":
        return float(phase.get("g", 0.8))
    if phase.kind == "blendphase":
        parts = phase.all("phase")
        phase.read.update(phase.values)
        if len(parts) == 2 and parts[1].name == "phase_1":
            # As written by reference/mitsuba_media.py: the medium's, then the volume's own.
            _mean_cosine(parts[0], source)
            return _mean_cosine(parts[1], source)
    source.note(f"{phase} is read as isotropic")
    return 0.0
