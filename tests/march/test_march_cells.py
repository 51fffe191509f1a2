"""Packed cells hold what the textures say, to the bit."""

from __future__ import annotations

import numpy as np

from airlight.gpu.commands import Commands
from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.lattice.placement import Placement
from airlight.lattice.table import LatticeTable
from airlight.march.march_cells import MarchCells

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
    packed = MarchCells(gpu).encode(commands, COUNT, {
        "lattices": table, "lattice_walls": texture("walls", "rgba8snorm", walls),
        "lattice_open_a": texture("open a", "rgba8unorm", opened[0]),
        "lattice_open_b": texture("open b", "rgba8unorm", opened[1]), "more": None,
    })  # fmt: skip
    commands.submit()
    words = packed.read(np.uint8).reshape(z, y, x, 4, 4)
    np.testing.assert_array_equal(words[..., 0, :], opened[0])
    np.testing.assert_array_equal(words[..., 1, :], opened[1])
    np.testing.assert_array_equal(words[..., 2, :3].view(np.int8), walls[..., :3])
    # The wall on a cell's high face is the next one's low wall; beyond the last there is none.
    for axis in range(3):
        high = np.zeros((z, y, x), np.int8)
        to, of = [slice(None)] * 3, [slice(None)] * 3
        to[2 - axis], of[2 - axis] = slice(None, -1), slice(1, None)
        high[tuple(to)] = walls[(*of, axis)]
        np.testing.assert_array_equal(words[..., 3, axis].view(np.int8), high)
