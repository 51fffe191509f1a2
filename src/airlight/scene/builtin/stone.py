"""Stone, plaster, tiles and terracotta: tileable colour, roughness and normal maps.

Linear albedos follow measured stone: limestone .45 to .65, terracotta .1 to .5 by channel.
"""

from __future__ import annotations

import numpy as np

from ..checks import Rgb
from .images import Field, patterned
from .noise import fractal_noise, smoothstep
from .patch import Finish

_SHAPE = (512, 512)  # of maps that are seldom seen from near


def limestone_blocks(rng: np.random.Generator, size_px: int = 1024) -> Finish:
    """Ashlar: eight courses of four blocks, 0.6 x 0.3 m, worn, joints 1 cm wide."""
    tile_m, courses, blocks = 2.4, 8, 4
    y, x = _grid(size_px)
    # Which block a texel is in, and how far from the joint.
    course = np.floor(y * courses)
    along = x * blocks + 0.5 * (course % 2)
    block = np.floor(along) % blocks
    joint_m = np.minimum(
        _edge_distance(along) * tile_m / blocks, _edge_distance(y * courses) * tile_m / courses
    )
    grain = fractal_noise((size_px, size_px), (12, 12), rng, octaves=6, gain=0.6)
    stain = fractal_noise((size_px, size_px), (2, 3), rng, octaves=4)
    face = smoothstep(0.002, 0.014, joint_m + 0.0015 * grain)
    # Blocks differ in brightness, warmth and height; all have grain, and stains across them.
    index = (course * blocks + block).astype(np.intp)
    shade = rng.normal(0.0, 1.0, (3, courses * blocks)).astype(np.float32)
    grey = (1.0 + 0.08 * shade[0][index] + 0.045 * grain + 0.05 * stain) * (0.62 + 0.38 * face)
    warmth = 0.035 * shade[1][index] + 0.02 * stain
    tint = np.stack([0.60 * (1 + warmth), np.full_like(x, 0.525), 0.43 * (1 - warmth)], -1)
    height = 0.006 * face + 0.0007 * grain * face + 0.0012 * shade[2][index] * face
    return patterned("limestone blocks", tile_m, grey, tint, height, 0.9)


def carved_limestone(rng: np.random.Generator) -> Finish:
    """Smooth, faintly veined limestone for columns and mouldings."""
    tile_m = 1.5
    # Noise that tiles, at three scales; veins are where noise passes zero.
    grain = fractal_noise(_SHAPE, (16, 16), rng, octaves=5, gain=0.65)
    cloud = fractal_noise(_SHAPE, (3, 3), rng, octaves=4)
    vein = np.exp(-40.0 * np.abs(fractal_noise(_SHAPE, (2, 3), rng, octaves=5)))
    grey = 1.0 + 0.03 * grain + 0.05 * cloud - 0.12 * vein
    return patterned("carved limestone", tile_m, grey, (0.63, 0.565, 0.475), 0.0005 * grain, 0.7)


def plaster(rng: np.random.Generator, color: Rgb = (0.64, 0.60, 0.53)) -> Finish:
    """Trowelled plaster with faint clouds."""
    tile_m = 2.0
    # Clouds of colour, and the marks of the trowel as relief.
    cloud = fractal_noise(_SHAPE, (3, 3), rng, octaves=5)
    trowel = fractal_noise(_SHAPE, (10, 5), rng, octaves=4)
    grey = 1.0 + 0.035 * cloud + 0.015 * trowel
    return patterned("plaster", tile_m, grey, color, 0.0012 * trowel, 0.95)


def paving(rng: np.random.Generator, size_px: int = 1024) -> Finish:
    """Courtyard slabs, 0.6 x 0.6 m, every one a little different, foot-worn to a dull shine."""
    tile_m, count = 2.4, 4
    y, x = _grid(size_px)
    # Which slab a texel is in, and how far from the joint.
    index = (np.floor(y * count) * count + np.floor(x * count)).astype(np.intp)
    joint_m = np.minimum(_edge_distance(x * count), _edge_distance(y * count)) * (tile_m / count)
    grain = fractal_noise((size_px, size_px), (10, 10), rng, octaves=6, gain=0.6)
    wear = fractal_noise((size_px, size_px), (3, 3), rng, octaves=4)
    face = smoothstep(0.002, 0.010, joint_m + 0.001 * grain)
    # Slabs differ in brightness, warmth and height; worn ones are smoother than joints.
    shade = rng.normal(0.0, 1.0, (3, count * count)).astype(np.float32)
    grey = (1.0 + 0.11 * shade[0][index] + 0.05 * grain + 0.04 * wear) * (0.45 + 0.55 * face)
    warmth = 0.05 * shade[1][index]
    tint = np.stack([0.50 * (1 + warmth), np.full_like(x, 0.445), 0.375 * (1 - warmth)], -1)
    height = 0.005 * face + 0.0006 * grain * face + 0.0010 * shade[2][index] * face
    rough = 0.62 + 0.25 * (1.0 - face) + 0.05 * wear + 0.04 * grain
    return patterned("paving", tile_m, grey, tint, height, rough)


def diamond_tiles(rng: np.random.Generator) -> Finish:
    """Gallery floor: pale marble tiles set on their corners, with dark and red ones between."""
    tile_m, count = 1.6, 2
    y, x = _grid(_SHAPE[0])
    # Tiles along the diagonals: pale ones, with dark and red ones between.
    a, b = (x + y) * count, (x - y) * count
    joint_m = np.minimum(_edge_distance(a), _edge_distance(b)) * (tile_m / count / np.sqrt(2.0))
    dark = (np.floor(a) + np.floor(b)) % 2
    red = dark * (np.floor(a) % 2)
    # Veins run through the pale tiles darker, through the dark ones lighter.
    marble = fractal_noise(_SHAPE, (4, 4), rng, octaves=6, gain=0.6)
    vein = np.exp(-25.0 * np.abs(fractal_noise(_SHAPE, (3, 3), rng, octaves=5)))
    # Joints are darker and rougher than the tiles, and lie deeper.
    face = smoothstep(0.0015, 0.006, joint_m.astype(np.float32))
    grey = (1.0 + 0.05 * marble - (0.15 - 0.35 * dark) * vein) * (0.4 + 0.6 * face)
    pale, brown, rust = (np.array(c, np.float32) for c in _TILE_COLORS)
    tint = pale + dark[..., None] * (brown - pale) + red[..., None] * (rust - brown)
    rough = 0.38 + 0.05 * marble + 0.5 * (1.0 - face)
    return patterned("gallery tiles", tile_m, grey, tint, 0.002 * face, rough)


_TILE_COLORS: tuple[Rgb, Rgb, Rgb] = ((0.56, 0.52, 0.45), (0.17, 0.15, 0.13), (0.33, 0.16, 0.10))


def terracotta(rng: np.random.Generator) -> Finish:
    """Fired clay with turning marks and lime bloom."""
    tile_m = 1.0
    # Marks of the wheel run around, so that their noise is stretched along the width.
    grain = fractal_noise(_SHAPE, (16, 16), rng, octaves=5)
    marks = fractal_noise(_SHAPE, (48, 2), rng, octaves=3)
    bloom = smoothstep(0.4, 2.0, fractal_noise(_SHAPE, (4, 4), rng, octaves=5))[..., None]
    # Lime blooms in patches; marks and grain show as colour and as relief.
    clay, lime = np.array([0.46, 0.20, 0.11], np.float32), np.array([0.52, 0.38, 0.28], np.float32)
    grey = 1.0 + 0.06 * grain + 0.05 * marks
    tint = clay + 0.7 * bloom * (lime - clay)
    height = 0.0006 * marks + 0.0003 * grain
    return patterned("terracotta", tile_m, grey, tint, height, 0.85)


def _grid(size_px: int) -> tuple[Field, Field]:
    """(y, x) in [0, 1) at texel centres, y downwards."""
    at = (np.arange(size_px, dtype=np.float32) + 0.5) / size_px
    y, x = np.meshgrid(at, at, indexing="ij")
    return y, x


def _edge_distance(cells: Field) -> Field:
    """Distance to the nearest whole number: to the nearest joint, in cells."""
    return np.abs(cells - np.round(cells))
