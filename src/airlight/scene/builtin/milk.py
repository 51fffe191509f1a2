"""A knot of milk: a closed mesh voxelised into a dense medium."""

from __future__ import annotations

import numpy as np

from ...maths.solid_voxels import soft_rim, solid_voxels
from ..camera import Camera
from ..checks import F32, F64, Bounds, Vec3
from ..lights import DirectionalLight
from ..medium import extinction_and_albedo
from ..mesh import Geometry
from ..scene import Scene
from ..volume import Volume
from . import stone
from .patch import f32, lattice_normals, patch
from .sky import clear_sky
from .solids import box

SHAPE = (144, 108, 144)
"""Cells of the density grid, (z, y, x)."""

BOUNDS: Bounds = ((-0.75, 0.0, -0.75), (0.75, 1.125, 0.75))

TUBE_M = 0.12
SIGMA_S = (51.0, 64.2, 75.4)
SIGMA_A = (0.022, 0.048, 0.28)
"""m^-1: a fiftieth of whole milk's reduced scattering and absorption (Jensen2001), so that a tube
of 24 cm has the colours of a drop of 5 mm."""

SUN_TRAVEL: Vec3 = (0.42, -0.52, 0.74)


def milk() -> Scene:
    """A trefoil knot of milk on stone, the sun behind it.

    One grid of 144 x 108 x 144 over 1.5 x 1.125 x 1.5 m, voxelised from a closed mesh; scattering
    51/64/75 per metre, absorption 0.02/0.05/0.28 per metre, g 0.6.
    """
    sigma_t, albedo = extinction_and_albedo(SIGMA_S, SIGMA_A)
    rng = np.random.default_rng(3)
    slab = box((-3.0, -0.1, -3.0), (3.0, 0.0, 3.0))
    return Scene(
        name="milk",
        meshes=stone.paving(rng, size_px=512).meshes(slab, "floor"),
        lights=(DirectionalLight(SUN_TRAVEL, (30.0, 27.0, 22.0)),),
        environment=clear_sky(SUN_TRAVEL),
        camera=Camera((0.0, 1.05, 2.5), (0.0, 0.45, 0.0), fov_y_deg=38.0, exposure_stops=-2.9),
        volumes=(
            Volume(
                sigma_t=sigma_t,
                density=knot_density(),
                bounds=BOUNDS,
                albedo=albedo,
                g=(0.6, 0.6, 0.6),
                source="builtin milk",
            ),
        ),
    )


def knot_density() -> F32:
    """Density (z, y, x): 1 in the knot, its rim three voxels wide."""
    mesh = knot()
    z, y, x = SHAPE
    low, high = np.array(BOUNDS)
    inside = solid_voxels(
        mesh.positions.astype(np.float64), mesh.indices.astype(np.int64), low, high, (x, y, z)
    )
    return f32(soft_rim(inside))


def knot(stations: int = 192, sides: int = 24) -> Geometry:
    """A tube of radius TUBE_M around a trefoil, leaning back, closed."""
    # A trefoil: (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t), a little deeper.
    t = np.linspace(0.0, 2.0 * np.pi, stations + 1)
    line = np.stack(
        [
            np.sin(t) + 2.0 * np.sin(2.0 * t),
            np.cos(t) - 2.0 * np.cos(2.0 * t),
            -1.3 * np.sin(3.0 * t),
        ],
        axis=-1,
    )
    # Leaned back and stood on the ground.
    lean = np.radians(50.0)
    turn = np.array(
        [[1.0, 0.0, 0.0], [0.0, np.cos(lean), -np.sin(lean)], [0.0, np.sin(lean), np.cos(lean)]]
    )
    line = 0.172 * line @ turn.T
    line[:, 1] += TUBE_M + 0.02 - line[:, 1].min()
    ring = _rings(line, np.linspace(0.0, 2.0 * np.pi, sides + 1))
    uvs = np.zeros((*ring.shape[:2], 2))
    return patch(ring, lattice_normals(ring, closed_columns=True), uvs)


def _rings(line: F64, angle: F64) -> F64:
    """Points (stations, sides, 3) around a closed line, in frames that turn with its curvature."""
    # Tangents and curvatures by differences to both neighbours of each station.
    ahead, behind = np.roll(line[:-1], -1, axis=0), np.roll(line[:-1], 1, axis=0)
    along = (ahead - behind)[np.r_[0 : len(line) - 1, 0]]
    inward = (ahead + behind - 2.0 * line[:-1])[np.r_[0 : len(line) - 1, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    # The frame at right angles, around which a circle makes the tube's ring.
    across = np.cross(along, inward)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    inward = np.cross(across, along)
    around = np.cos(angle)[:, None] * inward[:, None] + np.sin(angle)[:, None] * across[:, None]
    return np.asarray(line[:, None] + TUBE_M * around)
