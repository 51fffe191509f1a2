"""Stone, wood, cloth and leaves: believable albedos, no seams, masks that are leaves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.maths.colour import srgb_decode
from airlight.scene.builtin import fabric, foliage, stone, wood
from airlight.scene.builtin.patch import Finish

TILEABLE: dict[str, tuple[Callable[[np.random.Generator], Finish], float, float]] = {
    "blocks": (stone.limestone_blocks, 0.42, 0.62),
    "carved": (stone.carved_limestone, 0.48, 0.62),
    "plaster": (stone.plaster, 0.52, 0.66),
    "paving": (stone.paving, 0.35, 0.52),
    "tiles": (stone.diamond_tiles, 0.22, 0.45),
    "terracotta": (stone.terracotta, 0.15, 0.40),
    "boards": (wood.boards, 0.15, 0.35),
    "timber": (wood.timber, 0.25, 0.40),
}


@pytest.mark.parametrize("name", TILEABLE)
def test_albedo_and_seams(name: str) -> None:
    make, low, high = TILEABLE[name]
    finish = make(np.random.default_rng(0))
    image = finish.material.base_color_texture
    assert image is not None and finish.material.normal_texture is not None
    assert min(image.pixels.shape[:2]) >= 512 and 0.2 < finish.tile_m < 3.0
    assert low < srgb_decode(image.pixels[..., :3] / 255.0).mean() < high
    grey = image.pixels[..., :3].astype(float).mean(axis=2)
    # A joint may run along the border, so a seam may be as steep as the steepest line inside.
    for rows in (grey, grey.T):
        steps = np.abs(np.diff(rows, axis=0, append=rows[:1])).mean(axis=1)
        assert steps[-1] <= 1.3 * steps[:-1].max()


def test_cloths_share_one_weave() -> None:
    cloths = fabric.woven(
        np.random.default_rng(0), {"red": (0.6, 0.1, 0.1), "sand": (0.7, 0.6, 0.4)}
    )
    assert set(cloths) == {"red", "sand"}
    red, sand = cloths["red"].material, cloths["sand"].material
    assert red.base_color_texture is sand.base_color_texture and red.two_sided
    assert red.base_color == (0.6, 0.1, 0.1)


def test_a_drape_has_folds_and_hangs() -> None:
    cloth = fabric.drape(1.85, 5.3, np.random.default_rng(1))
    p = cloth.positions[cloth.indices].astype(np.float64)
    area = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1).sum() / 2
    assert 1.25 < area / (1.85 * 5.3) < 2.5
    low, high = cloth.positions.min(axis=0), cloth.positions.max(axis=0)
    assert high[1] < 0.05 and low[1] == pytest.approx(-5.3, abs=0.1)
    assert max(-low[2], high[2]) < 0.35 and high[0] - low[0] < 2.1


def test_fronds_are_cut_out_of_their_image() -> None:
    finish = foliage.frond_finish(np.random.default_rng(0))
    alpha = finish.material.base_color_texture.pixels[..., 3]
    assert finish.material.alpha_cutoff == 0.5
    assert 0.35 < (alpha >= 128).mean() < 0.75
    assert alpha[-1, 256] == 255 and alpha[:, 0].max() == 0
    green = finish.material.base_color_texture.pixels[..., :3].reshape(-1, 3).mean(axis=0)
    assert green[1] > 1.2 * green[0] and green[1] > 1.5 * green[2]


def test_a_plant_spreads_above_its_pot() -> None:
    leaves = foliage.fronds(np.random.default_rng(0))
    low, high = leaves.positions.min(axis=0), leaves.positions.max(axis=0)
    assert 0.7 < high[1] < 1.7 and low[1] > -0.6
    assert np.all(high[[0, 2]] > 0.5) and np.all(low[[0, 2]] < -0.5)
    assert leaves.normals[:, 1].mean() > 0.4
    pot, soil = foliage.pot(), foliage.soil()
    assert soil.positions[:, 1].max() < pot.positions[:, 1].max()
