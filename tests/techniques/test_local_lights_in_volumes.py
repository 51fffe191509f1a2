"""A lamp inside a volume: what it scatters once is as sharp as its fall-off, not as cells are."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.rendering import render
from airlight.scene import AreaLight, Camera, PointLight, Scene, Volume

LOW, HIGH = np.array([-1.0, -1.0, -1.0]), np.array([1.0, 1.0, 1.0])
LIGHT, INTENSITY, SIGMA_T, ALBEDO, G = np.array([0.13, 0.07, 0.21]), 2.0, 1.2, 0.05, 0.3
EYE, FOV_DEG, SIZE = np.array([0.0, 0.0, 4.0]), 36.0, (33, 25)


def directions() -> np.ndarray:
    """Unit directions of the eye rays through the middles of pixels, (h, w, 3)."""
    width, height = SIZE
    half = np.tan(np.radians(0.5 * FOV_DEG))
    y, x = np.mgrid[0:height, 0:width] + 0.5
    across, up = (2.0 * x / width - 1.0) * half * width / height, (1.0 - 2.0 * y / height) * half
    rays = np.stack([across, up, -np.ones_like(x)], axis=-1)
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def inside(origins: np.ndarray, rays: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where rays enter and leave the box, m."""
    with np.errstate(divide="ignore"):
        ends = np.sort([(LOW - origins) / rays, (HIGH - origins) / rays], axis=0)
    return ends[0].max(axis=-1), ends[1].min(axis=-1)


def scattered_once(light: np.ndarray = LIGHT, *, lobe: bool = False) -> np.ndarray:
    """Radiance, W m^-2 sr^-1, by a quadrature that takes equal angles about the lamp.

    `lobe`: it sends by the cosine, downwards.
    """
    rays = directions()
    begin, end = inside(EYE, rays)
    near = (light - EYE) @ np.moveaxis(rays, -1, 0).reshape(3, -1)
    near = near.reshape(begin.shape)
    h = np.linalg.norm(EYE + near[..., None] * rays - light, axis=-1)
    is_hit = begin < end
    a, b = np.arctan((begin - near) / h), np.arctan((end - near) / h)
    total = np.zeros(begin.shape)
    steps = 400
    for k in range(steps):
        t = near + h * np.tan(a + (b - a) * (k + 0.5) / steps)
        away = EYE + t[..., None] * rays - light
        r = np.linalg.norm(away, axis=-1)
        mu = -np.einsum("...i,...i", away, rays) / r
        phase = (1 - G * G) / (4 * np.pi * (1 + G * G - 2 * G * mu) ** 1.5)
        sent = np.maximum(-away[..., 1] / r, 0.0) if lobe else 1.0
        total += sent * phase * np.exp(-SIGMA_T * (r + t - begin)) * (b - a) / steps / h
    return np.where(is_hit, SIGMA_T * ALBEDO * INTENSITY * total, 0.0)


@pytest.mark.parametrize("shape", ["box", "grid"])
@pytest.mark.parametrize("technique", ["pop", "lpv with pop"])
def test_single_scattering_of_a_light_is_the_quadratures(shape, technique):
    density = np.ones((12, 12, 12), np.float32) if shape == "grid" else None
    volume = Volume(
        SIGMA_T,
        density,
        shape=shape,
        bounds=(tuple(LOW), tuple(HIGH)),
        albedo=(ALBEDO,) * 3,
        g=(G,) * 3,
    )
    light = PointLight(tuple(LIGHT), (INTENSITY,) * 3)
    camera = Camera(tuple(EYE), (0.0, 0.0, 0.0), fov_y_deg=FOV_DEG)
    scene = Scene(volumes=(volume,), lights=(light,), camera=camera)
    settings = {"grid": 10, "ordinates": 8}
    name = "pop" if technique == "pop" else "auto"
    if name == "auto":
        settings |= {"resolution": 8, "march_resolution": "full"}
    image = render(scene, name, SIZE, samples=1, settings=settings).radiance[..., 0]
    truth = scattered_once()
    # Three hundredths are the light that is scattered again: the albedo is a twentieth.
    assert image.sum() / truth.sum() == pytest.approx(1.02, abs=0.03)
    near = truth > 0.3 * truth.max()
    assert near.sum() >= 4
    np.testing.assert_allclose(image[near], truth[near], rtol=0.05)


@pytest.mark.parametrize("shape", ["box", "grid"])
def test_a_panel_inside_a_volume_loses_no_light(shape):
    """Its samples are softened, so that they are no dots; until that kept their light: .73."""
    density = np.ones((12, 12, 12), np.float32) if shape == "grid" else None
    bounds = (tuple(LOW), tuple(HIGH))
    albedo, g = (ALBEDO,) * 3, (G,) * 3
    volume = Volume(SIGMA_T, density, shape=shape, bounds=bounds, albedo=albedo, g=g)
    width, height = 0.6, 0.5
    panel = AreaLight(
        tuple(LIGHT), (INTENSITY / (width * height),) * 3, size=(width, height), visible=False
    )
    camera = Camera(tuple(EYE), (0.0, 0.0, 0.0), fov_y_deg=FOV_DEG)
    scene = Scene(volumes=(volume,), lights=(panel,), camera=camera)
    image = render(scene, "single", SIZE, samples=1)
    found = image.layers["single_scatter"][..., 0].sum()
    x, z = ((np.arange(8) + 0.5) / 8 - 0.5) * width, ((np.arange(8) + 0.5) / 8 - 0.5) * height
    truth = np.mean(
        [scattered_once(LIGHT + np.array([a, 0, b]), lobe=True).sum() for a in x for b in z]
    )
    # The rest: phase functions and depths of a sample's point, and what is beyond the box.
    assert found / truth == pytest.approx(1.0, abs=0.1)
