"""The atrium keeps its promises: budget, closed walls, sun patch, even texels, sane albedos."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.scene import Scene
from airlight.scene.builtin import atrium_shell as shell
from airlight.scene.builtin.atrium import SUN_TRAVEL, bay_places, column_places

RNG = np.random.default_rng(0)
DOWN = np.array([0.0, -1.0, 0.0])


def test_budget(atrium_scene: Scene) -> None:
    assert 240_000 <= atrium_scene.triangle_count <= 275_000
    textures = {
        id(t): t.pixels.nbytes
        for m in atrium_scene.meshes
        for t in (
            m.material.base_color_texture,
            m.material.normal_texture,
            m.material.metallic_roughness_texture,
        )
        if t is not None
    }
    assert sum(textures.values()) < 64e6
    shared = len({id(m.geometry) for m in atrium_scene.meshes})
    assert shared < 40 and len(atrium_scene.meshes) < 350


def test_bays_and_columns_ring_the_court() -> None:
    bays, columns = np.array(bay_places(0.0)), np.array(column_places(0.0))
    assert len(bays) == 22 and len(columns) == 18
    inwards = -np.sign(bays[:, :3, 3]) * (np.abs(bays[:, :3, 2]) > 0.5)
    assert np.allclose(bays[:, :3, 2], inwards, atol=1e-12)


def test_only_the_open_roof_lets_vertical_rays_in(atrium_scene: Scene, atrium_caster) -> None:
    low, high = atrium_scene.bounds
    xz = RNG.uniform(low[[0, 2]], high[[0, 2]], (160, 2))
    origins = np.stack([xz[:, 0], np.full(160, 20.0), xz[:, 1]], axis=1)
    height = 20.0 - atrium_caster(origins, np.tile(DOWN, (160, 1)))
    overhang = 0.43
    open_sky = (np.abs(xz[:, 0]) < shell.COURT_X_M - overhang) & (
        np.abs(xz[:, 1]) < shell.COURT_Z_M - overhang
    )
    covered = (np.abs(xz[:, 0]) > shell.COURT_X_M) | (np.abs(xz[:, 1]) > shell.COURT_Z_M)
    assert np.all(height[covered] >= shell.ROOF_M - 1e-6)
    assert np.all(height[open_sky] < 2.0) and np.median(height[open_sky]) < 1e-6


def test_horizontal_rays_never_escape(atrium_caster) -> None:
    count = 100
    angle = RNG.uniform(0, 2 * np.pi, count)
    directions = np.stack([np.cos(angle), np.zeros(count), np.sin(angle)], axis=1)
    inner = np.array([shell.INNER_X_M - 0.1, 11.2, shell.INNER_Z_M - 0.1])
    origins = RNG.uniform(-inner, inner, (count, 3))
    origins[:, 1] = np.abs(origins[:, 1]) + 0.05
    distance = atrium_caster(origins, directions)
    ends = origins + distance[:, None] * directions
    assert np.all(np.isfinite(distance))
    assert np.all(np.abs(ends[:, 0]) <= shell.INNER_X_M + 1e-4)
    assert np.all(np.abs(ends[:, 2]) <= shell.INNER_Z_M + 1e-4)


def test_gallery_ceilings_are_thick(atrium_caster) -> None:
    """From a gallery straight up: the vault; from above straight down: the next floor."""
    xz = np.array([[-8.4, 5.7], [3.1, -6.6], [11.7, 5.7], [-12.9, 0.3], [9.6, 6.0]])
    for floor in (0.0, 5.8):
        up = np.stack([xz[:, 0], np.full(5, floor + 1.0), xz[:, 1]], axis=1)
        ceiling = floor + 1.0 + atrium_caster(up, np.tile(-DOWN, (5, 1)))
        assert np.all(ceiling <= floor + 5.8 - 0.3)
        above = np.stack([xz[:, 0], np.full(5, floor + 5.9), xz[:, 1]], axis=1)
        top = floor + 5.9 - atrium_caster(above, np.tile(DOWN, (5, 1)))
        assert np.allclose(top, floor + 5.8, atol=1e-5)


def test_the_sun_reaches_part_of_the_floor_and_the_low_wall(atrium_caster) -> None:
    to_sun = -np.array(SUN_TRAVEL) / np.linalg.norm(SUN_TRAVEL)
    x, z = np.meshgrid(np.linspace(-8, 8, 9), np.linspace(-2.9, 2.9, 9))
    floor = np.stack([x.ravel(), np.full(x.size, 0.01), z.ravel()], axis=1)
    lit = np.isinf(atrium_caster(floor, np.tile(to_sun, (len(floor), 1))))
    assert 0.1 < lit.mean() < 0.6
    spandrels = np.array([[x, 4.4, shell.COURT_Z_M - 0.01] for x in np.arange(-4.8, 7.4, 2.4)])
    assert np.isinf(atrium_caster(spandrels, np.tile(to_sun, (len(spandrels), 1)))).mean() > 0.6


def test_texels_are_even(atrium_scene: Scene) -> None:
    """Image repeats per metre: within 25 % of the material's own on nine tenths of its area."""
    stone = ("limestone blocks", "carved limestone", "plaster", "paving", "gallery tiles")
    for name in stone:
        density, area = [], []
        for mesh in atrium_scene.meshes:
            if mesh.material.name != name or mesh.name in ("fountain", "lion shield"):
                continue
            triangles = mesh.geometry.indices
            p = mesh.geometry.positions[triangles].astype(np.float64)
            world = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1)
            uv = mesh.geometry.uvs[triangles].astype(np.float64)
            e1, e2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
            image = np.abs(e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0])
            density.append(np.sqrt(image / world))
            area.append(world)
        repeats, weight = np.concatenate(density), np.concatenate(area)
        middle = np.average(repeats, weights=weight)
        even = np.abs(repeats / middle - 1.0) < 0.25
        assert weight[even].sum() > 0.9 * weight.sum(), name


@pytest.mark.parametrize(
    ("name", "low", "high"), [("limestone", 0.42, 0.65), ("plaster", 0.45, 0.68)]
)
def test_stone_albedo(atrium_scene: Scene, name: str, low: float, high: float) -> None:
    materials = {m.material.name: m.material for m in atrium_scene.meshes}
    for key, material in materials.items():
        if name in key:
            encoded = material.base_color_texture.pixels[..., :3] / 255.0
            assert low < ((encoded + 0.055) / 1.055).__pow__(2.4).mean() < high


def test_camera_sees_into_the_court_at_eye_height(atrium_scene: Scene, atrium_caster) -> None:
    camera = atrium_scene.camera
    assert 1.5 < camera.position[1] < 1.9
    look = np.subtract(camera.target, camera.position)
    free = atrium_caster(np.array([camera.position]), (look / np.linalg.norm(look))[None])
    assert free[0] > 8.0
