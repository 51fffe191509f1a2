"""Mirrored directions by chance against quadrature of the BRDF; WGSL against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.maths import ggx_sampling
from airlight.maths.sampling import r2_sequence

COUNT = 4096


def mirrored(n_v: float, alpha: float, count: int = COUNT):
    """Directions (n, 3) towards light, and cosines of the microfacets' normals with the surface."""
    v = np.array([np.sqrt(1.0 - n_v * n_v), 0.0, n_v])
    h = ggx_sampling.visible_normal(v, alpha, r2_sequence(count))
    return 2.0 * (h @ v)[:, None] * h - v, h[:, 2]


def integral(n_v: float, alpha: float) -> float:
    """Of the BRDF without Fresnel's term times the cosine, over half vectors by quadrature.

    d(light) = 4 v.h d(h); half vectors are spaced evenly in what GGX's distribution adds up to.
    """
    count = 600
    share = (np.arange(count) + 0.5) / count
    z = np.sqrt((1.0 - share) / (1.0 + (alpha * alpha - 1.0) * share))
    flat, phi = np.sqrt(1.0 - z * z)[:, None], (np.arange(count) + 0.5) / count * 2.0 * np.pi
    v = np.array([np.sqrt(1.0 - n_v * n_v), 0.0, n_v])
    v_h = flat * np.cos(phi) * v[0] + z[:, None] * v[2]
    n_l = 2.0 * v_h * z[:, None] - n_v
    is_seen = (n_l > 0.0) & (v_h > 0.0)
    n_h = np.broadcast_to(z[:, None], v_h.shape)
    gloss = ggx_sampling.mirrored_gloss(n_h, np.maximum(n_l, 0.0), n_v, alpha)
    # The density of half vectors is D times their cosine.
    a2 = alpha * alpha
    d = a2 / (np.pi * (n_h**2 * (a2 - 1.0) + 1.0) ** 2)
    return float((gloss * 4.0 * v_h / (d * n_h) * is_seen).mean())


@pytest.mark.parametrize("roughness", [0.05, 0.2, 0.4, 0.8])
@pytest.mark.parametrize("n_v", [0.15, 0.5, 0.95])
def test_rays_add_up_to_the_brdf(roughness: float, n_v: float) -> None:
    alpha = roughness**2
    light, n_h = mirrored(n_v, alpha)
    density = ggx_sampling.mirrored_density(n_h, n_v, alpha)
    gloss = ggx_sampling.mirrored_gloss(n_h, np.maximum(light[:, 2], 0.0), n_v, alpha)
    # Each ray counts for no more than it was sent for.
    assert (gloss / density).max() <= 1.0 + 1e-9
    assert (gloss / density).mean() == pytest.approx(integral(n_v, alpha), abs=0.004)


def test_rays_come_as_often_as_their_density_says() -> None:
    """Shares of rays within 0.3, 0.6 .. of the mirrored direction, and the density added up."""
    n_v, alpha = 0.6, 0.3
    light, _ = mirrored(n_v, alpha)
    around = r2_sequence(200_000)
    z, phi = 2.0 * around[:, 0] - 1.0, 2.0 * np.pi * around[:, 1]
    flat = np.sqrt(1.0 - z * z)
    every = np.stack([flat * np.cos(phi), flat * np.sin(phi), z], axis=-1)
    v = np.array([np.sqrt(1.0 - n_v * n_v), 0.0, n_v])
    h = every + v
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    density = np.where(h[:, 2] > 0.0, ggx_sampling.mirrored_density(h[:, 2], n_v, alpha), 0.0)
    ideal = np.array([-v[0], 0.0, v[2]])
    for angle in (0.3, 0.6, 1.0):
        sent = (light @ ideal > np.cos(angle)).mean()
        asked = (density * (every @ ideal > np.cos(angle))).mean() * 4.0 * np.pi
        assert sent == pytest.approx(asked, abs=0.01)


def test_twins(wgsl) -> None:
    rng = np.random.default_rng(3)
    v = rng.normal(size=(500, 3))
    v[:, 2] = np.abs(v[:, 2]) + 0.01
    v = (v / np.linalg.norm(v, axis=1, keepdims=True)).astype(np.float32).astype(np.float64)
    alpha, *cosines = (x.astype(np.float32).astype(np.float64) for x in rng.random((4, 500)))
    alpha = np.maximum(alpha, np.float32(0.01)).astype(np.float64)
    u = rng.random((500, 2)).astype(np.float32).astype(np.float64)
    found = wgsl("ggx_sampling", "visible_normal", v, alpha, u, returns="vec3f")
    # WGSL grants sines 2^-11 (CPU adapters keep far nearer).
    np.testing.assert_allclose(found, ggx_sampling.visible_normal(v, alpha, u), atol=2e-3)
    n_h, n_l, n_v = cosines
    density = wgsl("ggx_sampling", "mirrored_density", n_h, n_v, alpha, returns="f32")
    expected = ggx_sampling.mirrored_density(n_h, n_v, alpha)
    np.testing.assert_allclose(density, expected, rtol=2e-3, atol=1e-6)
    gloss = wgsl("ggx_sampling", "mirrored_gloss", n_h, n_l, n_v, alpha, returns="f32")
    expected = ggx_sampling.mirrored_gloss(n_h, n_l, n_v, alpha)
    np.testing.assert_allclose(gloss, expected, rtol=2e-3, atol=1e-6)
