"""Lit intervals through density grids against fine quadrature, for every kind of light."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from airlight.reference.quadrature import box_path, henyey_greenstein, panels
from airlight.scene import (
    Camera,
    DirectionalLight,
    Light,
    Medium,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
    Volume,
)
from airlight.scene.shapes import quad

from .shaft_setups import BOX, RGB, SHEET_Y, TRAVEL, is_lit, unshaded

SIZE = (10, 8)
MAPS = (1024, 512)
PUFF = ((-1.3, -1.2, -1.3), (1.4, 1.5, 1.2))
LIGHTS: dict[str, Light] = {
    "directional": DirectionalLight(TRAVEL, RGB),
    "point": PointLight((0.3, 1.3, -0.2), RGB),
    "spot": SpotLight((0.3, 1.8, -0.2), (-0.2, -1.0, 0.1), RGB, 20.0, 40.0),
}
EYES = {"outside": (0.6, 0.4, 5.5), "inside": (0.5, 0.2, 1.0)}


def puff() -> np.ndarray:
    """(z, y, x): a Gaussian ball of smoke with a dent."""
    z, y, x = np.meshgrid(*((np.arange(n) + 0.5) / n * 2 - 1 for n in (24, 20, 22)), indexing="ij")
    ball = 1.5 * np.exp(-((x / 0.6) ** 2 + (y / 0.55) ** 2 + (z / 0.6) ** 2))
    return np.asarray(ball * (1.0 - 0.8 * np.exp(-8 * ((x - 0.3) ** 2 + y**2))), np.float32)


def smoky(light: Light, eye: Any, grid: np.ndarray) -> Scene:
    """A ball of smoke in thin fog, half of it under the sheet."""
    matrix = np.diag([40.0, 1.0, 40.0, 1.0])
    matrix[:3, 3] = (-20.0, SHEET_Y, 0.0)
    return Scene(
        meshes=(Mesh(quad(), world_from_object=matrix),),
        lights=(light,),
        medium=Medium((0.05, 0.1, 0.2), (0.9, 0.9, 0.9), (0.6, 0.6, 0.6), BOX),
        volumes=(Volume((2.0, 3.0, 4.0), grid, "grid", PUFF, (0.9, 0.6, 1.0), (0.3, 0.5, -0.2)),),
        camera=Camera(eye, (0.0, 0.2, -1.0), fov_y_deg=50),
    )


def density(grid: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Trilinear, voxel-centred, at points (..., 3); 0 outside."""
    low, high = (np.array(corner) for corner in PUFF)
    u = (p - low) / (high - low)
    q = np.clip(u * grid.shape[::-1] - 0.5, 0.0, np.array(grid.shape[::-1]) - 1.0)
    i = np.minimum(q.astype(int), np.array(grid.shape[::-1]) - 2)
    f = q - i
    total = np.zeros(p.shape[:-1])
    for corner in np.ndindex(2, 2, 2):
        x, y, z = (i[..., a] + corner[a] for a in range(3))
        total += grid[z, y, x] * np.prod(np.where(corner, f, 1.0 - f), axis=-1)
    return np.where(np.all((u >= 0.0) & (u <= 1.0), axis=-1), total, 0.0)


def depth(scene: Scene, p: np.ndarray, along: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """(..., 3): optical depth of the paths `along` (..., 3) from points, `reach` m long."""
    fog, smoke = scene.medium, scene.volumes[0]
    assert fog is not None and smoke.density is not None
    in_fog = np.minimum(box_path(p, along, BOX)[1], reach)
    entry, leave = box_path(p, along, PUFF)
    leave = np.minimum(leave, reach)
    entry = np.minimum(entry, leave)
    x, w = panels(6, 2)
    s = entry[..., None] + (leave - entry)[..., None] * x
    places = p[..., None, :] + s[..., None] * along[..., None, :]
    column = (density(smoke.density, places) * w).sum(axis=-1) * (leave - entry)
    return np.asarray(in_fog[..., None] * fog.sigma_t + column[..., None] * smoke.sigma_t)


def truth(scene: Scene, d: np.ndarray, count: int = 120) -> np.ndarray:
    """(H, W, 3): the midpoint rule along each eye ray, to the sheet or out of the fog."""
    light, fog, smoke = scene.lights[0], scene.medium, scene.volumes[0]
    assert fog is not None and smoke.density is not None
    eye = np.array(scene.camera.position)
    entry, leave = box_path(eye, d, BOX)
    with np.errstate(divide="ignore"):
        s = (SHEET_Y - eye[1]) / d[..., 1]
    hits = (s > 0) & (eye[0] + s * d[..., 0] < 0.0)
    leave = np.where(hits, np.clip(s, entry, leave), leave)
    dt = ((leave - entry) / count)[..., None]
    p = eye + (entry[..., None] + dt * (np.arange(count) + 0.5))[..., None] * d[..., None, :]
    travel, reach, gain, _, color = unshaded(light, p)
    mu = -np.sum(travel * d[..., None, :], axis=-1)
    smoke_here = density(smoke.density, p)[..., None] * smoke.sigma_t
    passed = np.cumsum(smoke_here + fog.sigma_t, axis=-2) - 0.5 * (smoke_here + fog.sigma_t)
    sent = np.array(fog.sigma_s) * henyey_greenstein(mu, fog.g[0])[..., None]
    phase = np.stack([henyey_greenstein(mu, g) for g in smoke.g], axis=-1)
    sent = sent + smoke_here * smoke.albedo * phase
    sent *= np.exp(-passed * dt[..., None] - depth(scene, p, -travel, reach))
    return np.asarray((sent * (gain * is_lit(light, p))[..., None]).sum(axis=-2) * dt * color)


@pytest.mark.parametrize("eye", EYES.values(), ids=EYES.keys())
@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
def test_smoke_in_fog_under_a_sheet(look: Any, scattered_once: Any, light: Light, eye: Any) -> None:
    seen = look(smoky(light, eye, puff()), SIZE)
    image, expected = scattered_once(seen, maps=MAPS), truth(seen.scene, seen.directions())
    # Measured .001 to .006; jitter .05 to .75.
    assert np.linalg.norm(image - expected) < 0.01 * np.linalg.norm(expected)
    assert image.sum() == pytest.approx(expected.sum(), rel=0.005)


def test_nothing_is_jittered(look: Any, scattered_once: Any) -> None:
    """Images of one thing are the same; those of an eye a little on differ by as little."""
    seen = look(smoky(LIGHTS["directional"], EYES["outside"], puff()), SIZE)
    first = scattered_once(seen, maps=MAPS)
    np.testing.assert_array_equal(scattered_once(seen, maps=MAPS, frame=3), first)
    x, y, z = EYES["outside"]
    seen = look(smoky(LIGHTS["directional"], (x, y, z - 0.01), puff()), SIZE)
    on = scattered_once(seen, maps=MAPS)
    smooth = slice(0, 5)  # above the sheet's edge, which moves over pixels
    off = np.linalg.norm(on[smooth] - first[smooth]) / np.linalg.norm(first[smooth])
    assert 0.0 < off < 0.01
