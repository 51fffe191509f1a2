"""Woven cloth: its texture, and hanging drapes with folds."""

from __future__ import annotations

import numpy as np

from ..checks import F64, Rgb
from ..material import Material
from ..mesh import Geometry
from .images import color_texture, normal_texture
from .noise import fractal_noise
from .patch import Finish, lattice_normals, patch

_SIDE_PX = 512


def woven(rng: np.random.Generator, colors: dict[str, Rgb]) -> dict[str, Finish]:
    """One finish per named linear colour, sharing the images of one plain weave."""
    # A weft or a warp thread every 5 mm.
    tile_m, threads = 0.32, 64
    at = (np.arange(_SIDE_PX, dtype=np.float32) + 0.5) / _SIDE_PX * threads
    weft, warp = np.meshgrid(at, at, indexing="ij")
    # Which thread is above at each crossing, and how its crown rises.
    over = (np.floor(weft) + np.floor(warp)) % 2
    crown = np.where(over > 0, np.sin(np.pi * (warp % 1)), np.sin(np.pi * (weft % 1)))
    # Threads are unevenly thick along their own direction.
    slub = fractal_noise((_SIDE_PX,) * 2, (4, 32), rng, octaves=3)
    slub += fractal_noise((_SIDE_PX,) * 2, (32, 4), rng, octaves=3)
    grey = (0.72 + 0.28 * crown) * (0.94 + 0.03 * slub)
    # One image of the weave for all colours, which are factors.
    image = color_texture(np.clip(grey, 0, 1).astype(np.float32), (1.0, 1.0, 1.0), "weave")
    normals = normal_texture((0.0008 * crown).astype(np.float32), tile_m, "weave normals")
    return {
        name: Finish(
            Material(
                name=f"{name} cloth",
                base_color=color,
                base_color_texture=image,
                normal_texture=normals,
                roughness=0.95,
                specular=0.5,
                two_sided=True,
            ),
            tile_m,
        )
        for name, color in colors.items()
    }


def drape(
    width_m: float,
    height_m: float,
    rng: np.random.Generator,
    *,
    pleats: float = 6.5,
    cells: tuple[int, int] = (66, 26),
) -> Geometry:
    """Cloth hung from a rod: centred on x, hanging from y = 0, folds along z.

    Pleats are even and tight at the rod; further down they widen, drift and merge. uv follow
    the cloth's own length, so the weave is never stretched. `cells` (across, down).
    """
    s = np.linspace(0.0, 1.0, cells[0] + 1)[None, :]
    t = np.linspace(0.0, 1.0, cells[1] + 1)[:, None]
    # The phase of the pleats drifts further down, where they widen and merge.
    fold_m = width_m / pleats
    drift = sum(
        amount * np.sin(2.0 * np.pi * (k * s + phase)) * t ** (0.5 * k)
        for k, amount, phase in zip(
            (1, 2, 3), rng.uniform(-0.5, 0.5, 3) / (1, 2, 3), rng.random(3), strict=True
        )
    )
    phase = 2.0 * np.pi * (pleats * s + drift)
    depth = fold_m * (
        0.20 + 0.27 * t * (1.0 + 0.5 * np.sin(2.0 * np.pi * (1.3 * s + rng.random())))
    )
    # The fold's cross section, sharp at the rod and rounder at the hem.
    shape = np.sin(phase) + 0.22 * np.sin(2.0 * phase + 1.0) * (1.0 - t)
    shape += 0.35 * np.sin(0.5 * phase + 2.0) * t
    z = depth * shape
    # The cloth narrows a little below the rod, and folds lean over to one side.
    x = width_m * (s - 0.5) * (1.0 - 0.05 * np.sin(np.pi * np.minimum(1.6 * t, 1.0)))
    x = x + 0.18 * depth * np.cos(phase)
    # The hem is uneven.
    hem = 0.09 * fold_m * t * (np.sin(phase * 0.5) + np.sin(2.0 * np.pi * s))
    y = -height_m * t + hem
    positions = np.stack(np.broadcast_arrays(x, y, z), axis=-1)
    return patch(positions, lattice_normals(positions), _cloth_uvs(positions))


def _cloth_uvs(positions: F64) -> F64:
    # Arc lengths along the mean row and column.
    across = np.linalg.norm(np.diff(positions, axis=1), axis=-1).mean(axis=0)
    down = np.linalg.norm(np.diff(positions, axis=0), axis=-1).mean(axis=1)
    u = np.concatenate([[0.0], np.cumsum(across)])
    v = np.concatenate([[0.0], np.cumsum(down)])
    return np.stack(np.broadcast_arrays(u[None, :], v[:, None]), axis=-1)
