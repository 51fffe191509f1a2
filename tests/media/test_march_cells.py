"""Packed cells hold what the textures say."""

from __future__ import annotations

import numpy as np

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.lattice.placement import Placement
from airlight.lattice.table import LatticeTable
from airlight.media.march.cells import MarchCells

COUNT = (6, 4, 5)  # x, y, z


def test_open_shares_and_walls(gpu: Gpu, commands: Commands) -> None:
    rng = np.random.default_rng(2)
    x, y, z = COUNT
    opened = rng.integers(0, 256, (2, z, y, x, 4), np.uint8)
    walls = rng.integers(-127, 128, (z, y, x, 4), np.int8)

    def texture(name: str, format: str, texels: np.ndarray) -> Texture:
        made = Texture(gpu, name, COUNT, format, dimension="3d")
        made.write(texels)
        return made

    table = LatticeTable(gpu).filled([Placement((0, 0, 0), 1.0, COUNT).params()])
    packed = MarchCells(gpu).encode(
        commands,
        COUNT,
        {
            "lattices": table,
            "lattice_walls": texture("walls", "rgba8snorm", walls),
            "lattice_visibility_a": texture("open a", "rgba8unorm", opened[0]),
            "lattice_visibility_b": texture("open b", "rgba8unorm", opened[1]),
            "more": None,
        },
    )
    commands.submit()
    words = packed.read().view(np.uint8).reshape(z, y, x, 4, 4)
    # As far as each face lets neighbours be mixed in: wgsl/lattice.wgsl, open_fraction.
    t = np.clip((opened / 255.0 - 0.15) / 0.35, 0.0, 1.0)
    mixed = 255.0 * t * t * (3.0 - 2.0 * t)
    low = np.stack([mixed[0, ..., 0], mixed[0, ..., 2], mixed[1, ..., 0]], axis=-1)
    high = np.stack([mixed[0, ..., 1], mixed[0, ..., 3], mixed[1, ..., 1]], axis=-1)
    np.testing.assert_allclose(words[..., 0, :3], low, atol=0.51)
    np.testing.assert_allclose(words[..., 1, :3], high, atol=0.51)
    np.testing.assert_array_equal(words[..., 2, :3].view(np.int8), walls[..., :3])
    # The wall on a cell's high face is the next one's low wall; beyond the last there is none.
    for axis in range(3):
        high = np.zeros((z, y, x), np.int8)
        to, of = [slice(None)] * 3, [slice(None)] * 3
        to[2 - axis], of[2 - axis] = slice(None, -1), slice(1, None)
        high[tuple(to)] = walls[(*of, axis)]
        np.testing.assert_array_equal(words[..., 3, axis].view(np.int8), high)
