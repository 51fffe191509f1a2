"""Wood: floor boards and plain timber."""

from __future__ import annotations

import numpy as np

from ..checks import F32, Rgb
from ..material import Material
from .images import color_texture, normal_texture, patterned, roughness_texture
from .noise import fractal_noise, smoothstep
from .patch import Finish


def boards(
    rng: np.random.Generator, color: Rgb = (0.42, 0.25, 0.13), size_px: int = 1024
) -> Finish:
    """Oiled floor boards along u, 0.16 m wide and 0.8 m long, each cut from another place."""
    tile_m, rows, per_row = 1.6, 10, 2
    texel = np.arange(size_px)
    # Which board a texel is in: rows are shifted against each other.
    row = texel * rows // size_px
    along = (texel[None, :] + (rng.integers(0, size_px, rows))[row][:, None]) / size_px
    board = row[:, None] * per_row + np.floor(along * per_row).astype(np.intp) % per_row
    grain = _grain(rng, size_px)
    # Each board is cut from another place of the same grain.
    shift = rng.integers(0, size_px, (2, rows * per_row))
    rolled = grain[
        (texel[:, None] + shift[0][board]) % size_px, (texel[None, :] + shift[1][board]) % size_px
    ]
    # How far from the joints between boards, along and across.
    across_m = np.abs((texel / size_px * rows + 0.5) % 1.0 - 0.5)[:, None] * tile_m / rows
    butt_m = np.abs((along * per_row + 0.5) % 1.0 - 0.5) * tile_m / per_row
    face = smoothstep(0.0005, 0.003, np.minimum(across_m, butt_m).astype(np.float32))
    # Boards differ in brightness; joints are dark and rough.
    shade = rng.normal(0.0, 1.0, rows * per_row).astype(np.float32)
    grey = (1.0 + 0.12 * shade[board] + 0.13 * rolled) * (0.45 + 0.55 * face)
    material = Material(
        name="floor boards",
        base_color=(1.0, 1.0, 1.0),
        base_color_texture=color_texture(grey, color, "boards"),
        metallic_roughness_texture=roughness_texture(
            0.45 - 0.05 * rolled + 0.4 * (1.0 - face), "boards roughness"
        ),
        normal_texture=normal_texture(0.0015 * face + 0.00008 * rolled, tile_m, "boards normals"),
        two_sided=False,
    )
    return Finish(material, tile_m)


def timber(rng: np.random.Generator, color: Rgb = (0.50, 0.33, 0.18), size_px: int = 512) -> Finish:
    """Planed wood with its grain along u, for furniture."""
    grain = _grain(rng, size_px)
    return patterned("timber", 1.0, 1.0 + 0.13 * grain, color, 0.00008 * grain, 0.5)


def _grain(rng: np.random.Generator, size_px: int) -> F32:
    """Fibres and growth rings along x: mean 0, deviation about 1."""
    shape = (size_px, size_px)
    # Fibres are long along x; rings are lines of equal noise, bent slowly.
    fibre = fractal_noise(shape, (size_px // 4, 4), rng, octaves=2)
    bend = fractal_noise(shape, (3, 1), rng, octaves=3)
    rings = np.sin(9.0 * bend + 2.0 * fractal_noise(shape, (12, 1), rng, octaves=2))
    return (0.55 * fibre + 0.9 * rings).astype(np.float32)
