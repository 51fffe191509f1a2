"""The albedo of light's bounces against quadrature over the reflection model itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.maths import reflection
from airlight.maths.reflection import SCHLICK_MEAN, bihemispherical_albedo

COUNT = 2000
RNG = np.random.default_rng(31)


def quadrature(base: float, metallic: float, roughness: float, specular: float) -> float:
    """Reflected over incident power: f of mitsuba_brdf.py over 200,000 pairs of directions.

    Both directions are distributed as their cosine, so the mean of pi f is the albedo; the
    glossy part is sampled by GGX's visible normals (Heitz2018), where it has no peak.
    """
    count = 200_000
    v = cosine_directions(count)
    f0 = 0.04 * specular * (1.0 - metallic) + base * metallic
    f90 = min(50.0 * f0, 1.0)

    half = v + cosine_directions(count)
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    lost = f0 + (f90 - f0) * (1.0 - np.clip((v * half).sum(1), 0.0, 1.0)) ** 5
    diffuse = base * (1.0 - metallic) * (1.0 - lost).mean()

    alpha = max(roughness**2, 0.002)
    half = visible_normals(v, alpha)
    v_h = (v * half).sum(1)
    l_z = 2.0 * v_h * half[:, 2] - v[:, 2]
    fresnel = f0 + (f90 - f0) * (1.0 - np.clip(v_h, 0.0, 1.0)) ** 5
    hidden, shadowed = smith(v[:, 2], alpha), smith(np.maximum(l_z, 1e-6), alpha)
    seen = np.where(l_z > 0.0, (1.0 + hidden) / (1.0 + hidden + shadowed), 0.0)
    return float(diffuse + (fresnel * seen).mean())


def cosine_directions(count: int) -> np.ndarray:
    u, phi = RNG.random(count), 2.0 * np.pi * RNG.random(count)
    radius = np.sqrt(u)
    return np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1.0 - u)], axis=1)


def smith(cosine: np.ndarray, alpha: float) -> np.ndarray:
    """Smith's lambda of GGX."""
    c2 = np.maximum(cosine**2, 1e-12)
    return 0.5 * (np.sqrt(1.0 + alpha**2 * (1.0 - c2) / c2) - 1.0)


def visible_normals(v: np.ndarray, alpha: float) -> np.ndarray:
    """Normals (n, 3) of microfacets as often as the direction `v` (n, 3) sees them (Heitz2018)."""
    stretched = v * [alpha, alpha, 1.0]
    stretched /= np.linalg.norm(stretched, axis=1, keepdims=True)
    length = np.maximum(np.hypot(stretched[:, 0], stretched[:, 1]), 1e-12)
    zero = np.zeros(len(v))
    across = np.stack([-stretched[:, 1] / length, stretched[:, 0] / length, zero], axis=1)
    along = np.cross(stretched, across)
    radius, phi = np.sqrt(RNG.random(len(v))), 2.0 * np.pi * RNG.random(len(v))
    a, b = radius * np.cos(phi), radius * np.sin(phi)
    share = 0.5 * (1.0 + stretched[:, 2])
    b = (1.0 - share) * np.sqrt(1.0 - a**2) + share * b
    c = np.sqrt(np.maximum(0.0, 1.0 - a**2 - b**2))
    normal = a[:, None] * across + b[:, None] * along + c[:, None] * stretched
    normal *= [alpha, alpha, 1.0]
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


@pytest.mark.parametrize("roughness", [0.0, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("base, metallic, specular", [(0.8, 0, 1), (0.2, 0, 1), (0.7, 1, 1)])
def test_albedo(base: float, metallic: float, specular: float, roughness: float) -> None:
    found = bihemispherical_albedo([[base] * 3], [metallic], [roughness], [specular])
    expected = quadrature(base, metallic, roughness, specular)
    # The fit is within .0018 and .0006 of its two parts, the quadrature's noise is below .001.
    np.testing.assert_allclose(found, expected, atol=0.0035)


def test_a_lambert_surface_reflects_its_colour() -> None:
    found = bihemispherical_albedo([[0.9, 0.5, 0.0]], [0.0], [1.0], [0.0])
    np.testing.assert_allclose(found, [[0.9, 0.5, 0.0]], rtol=1e-12)


def test_schlick_mean() -> None:
    v, light = cosine_directions(400_000), cosine_directions(400_000)
    half = v + light
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    mean = ((1.0 - (v * half).sum(1)) ** 5).mean()
    # The quantity's standard deviation is .02: its mean over 400,000 pairs is known within 3e-5.
    assert mean == pytest.approx(SCHLICK_MEAN, abs=1.2e-4)


def test_the_device_computes_the_same(wgsl: Callable[..., np.ndarray]) -> None:
    draws = [RNG.random((COUNT, 3)), RNG.random(COUNT), RNG.random(COUNT), RNG.random(COUNT)]
    inputs = [x.astype(np.float32).astype(np.float64) for x in draws]
    found = wgsl("bihemispherical_albedo", "bihemispherical_albedo", *inputs, returns="vec3f")
    np.testing.assert_allclose(found, bihemispherical_albedo(*inputs), atol=2e-6)


SURFACE = """surface_reflection
fn surface(d: vec3f, f0: vec3f, alpha: f32, l: vec3f, v: vec3f) -> vec3f {
    return reflection(Reflector(d, f0, alpha), vec3f(0.0, 0.0, 1.0), l, v);
}
fn matt(d: vec3f, f0: vec3f, l: vec3f, v: vec3f) -> vec3f {
    return matt_reflection(Reflector(d, f0, 1.0), l, v);
}"""


def test_light_from_one_direction_to_another(wgsl: Callable[..., np.ndarray]) -> None:
    """Both parts. Alphas from .05 on: below, GGX's peak magnifies the rounding of n.h."""
    light, v = (cosine_directions(COUNT).astype(np.float32) for _ in range(2))
    d, f0 = (RNG.random((COUNT, 3)).astype(np.float32) for _ in range(2))
    alpha = RNG.uniform(0.05, 1.0, COUNT).astype(np.float32)
    matt = reflection.matt_reflection(d, f0, light, v)
    got = wgsl(SURFACE, "matt", d, f0, light, v, returns="vec3f")
    np.testing.assert_allclose(got, matt, rtol=1e-5, atol=1e-6)
    coat = reflection.mirrored_reflection(f0, alpha, (0.0, 0.0, 1.0), light, v)
    got = wgsl(SURFACE, "surface", d, f0, alpha, light, v, returns="vec3f")
    np.testing.assert_allclose(got, matt + coat, rtol=2e-3, atol=1e-5)


@pytest.mark.parametrize("name", ["glow_share", "medium_glow_share"])
def test_what_mirrored_rays_show_of_things_that_glow(
    wgsl: Callable[..., np.ndarray], name: str
) -> None:
    alpha = np.linspace(0.0, 0.2, 200).astype(np.float32)
    want = getattr(reflection, name)(alpha)
    assert want[0] == 1.0
    assert want[-1] == 0.0
    np.testing.assert_allclose(wgsl("glow_share", name, alpha), want, atol=1e-6)
