"""Every WGSL library function gives what its NumPy namesake gives, in float32.

Tolerances are float32's, widened where the formula magnifies an input's rounding, and to what WGSL
grants a device's sine; both sides get the same float32 inputs.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from airlight.maths import medium, octahedron, phase, sampling, tone

Evaluate = Callable[..., np.ndarray]

RNG = np.random.default_rng(20)
COUNT = 3000


# WGSL, "Accuracy of Concrete Floating Point Expressions": sin and cos are within 2^-11.
SINE = 2.0**-11


def single(x: np.ndarray) -> np.ndarray:
    """Rounded to float32, kept as float64 for the truth."""
    return np.asarray(x, dtype=np.float32).astype(np.float64)


def unit(count: int = COUNT) -> np.ndarray:
    d = RNG.normal(size=(count, 3))
    return single(d / np.linalg.norm(d, axis=1, keepdims=True))


MU = single(RNG.uniform(-1.0, 1.0, COUNT))
G = single(np.concatenate([RNG.uniform(-0.97, 0.97, COUNT - 3), [0.0, 1e-6, -1e-6]]))
DEPTH = single(np.concatenate([[0.0], np.geomspace(1e-7, 80.0, COUNT - 1)]))


@pytest.mark.parametrize("name", ["henyey_greenstein", "henyey_greenstein_cumulative"])
def test_phase(wgsl: Evaluate, name: str) -> None:
    expected = getattr(phase, name)(MU, G)
    np.testing.assert_allclose(wgsl("phase", name, MU, G), expected, rtol=3e-4, atol=1e-6)


def test_phase_rgb_and_caps(wgsl: Evaluate) -> None:
    g3 = single(RNG.uniform(-0.9, 0.9, (COUNT, 3)))
    rgb = wgsl("phase", "henyey_greenstein_rgb", MU, g3, returns="vec3f")
    np.testing.assert_allclose(rgb, phase.henyey_greenstein(MU[:, None], g3), rtol=1e-4)
    rgb = wgsl("phase", "scattering_phase", MU, g3, returns="vec3f")
    np.testing.assert_allclose(rgb, phase.scattering_phase(MU[:, None], g3), rtol=1e-4)
    caps = wgsl("phase", "cap_fractions", G, returns="vec3f")
    np.testing.assert_allclose(caps, np.stack(phase.cap_fractions(G), axis=1), atol=2e-6)


def test_mean_transmittance(wgsl: Evaluate) -> None:
    mean = wgsl("medium", "mean_transmittance", DEPTH)
    np.testing.assert_allclose(mean, medium.mean_transmittance(DEPTH), rtol=3e-6, atol=1e-9)


def test_transmittance(wgsl: Evaluate) -> None:
    sigma = single(RNG.random((COUNT, 3)))
    length = single(RNG.random(COUNT) * 10.0)
    expected = medium.transmittance(sigma, length[:, None])
    t = wgsl("medium", "transmittance", sigma, length, returns="vec3f")
    np.testing.assert_allclose(t, expected, rtol=3e-6)
    rgb = wgsl("medium", "mean_transmittance_rgb", sigma, returns="vec3f")
    np.testing.assert_allclose(rgb, medium.mean_transmittance(sigma), rtol=3e-6)


def test_transmittance_from_within(wgsl: Evaluate) -> None:
    rng = np.random.default_rng(5)
    depth, inner = single(rng.random((300, 3)) * 12.0), single(rng.random((300, 3)) * 6.0)
    depth[:20], inner[20:60] = 0.0, 0.0
    found = wgsl("medium", "transmittance_from_within", depth, inner, returns="vec3f")
    np.testing.assert_allclose(found, medium.transmittance_from_within(depth, inner), rtol=1e-5)


def test_shares_in_one_number(wgsl: Evaluate) -> None:
    shares = single(np.random.default_rng(6).random((500, 3)))
    shares[:2] = [[0.0] * 3, [1.0] * 3]
    back = wgsl(
        "packed_shares",
        "unpacked_shares",
        wgsl("packed_shares", "packed_shares", shares),
        returns="vec3f",
    )
    np.testing.assert_allclose(back, shares, atol=0.5 / 255.0 + 1e-6)
    np.testing.assert_array_equal(back[:2], shares[:2])


def assert_same_interval(found: np.ndarray, t0: np.ndarray, t1: np.ndarray, atol: float) -> None:
    """Hits agree; rays that graze may be told apart by float32 only."""
    hit = (t1 - t0 > 0.05) & (np.isfinite(t0) | np.isfinite(t1))
    far = 1e30
    expected = np.clip(np.stack([t0, t1], axis=1), -far, far)[hit]
    np.testing.assert_allclose(np.clip(found, -far, far)[hit], expected, rtol=2e-4, atol=atol)
    missed = t0 > t1 + 1e-9
    assert (found[:, 0] > found[:, 1])[missed].mean() > 0.999


def test_ray_intervals(wgsl: Evaluate) -> None:
    o, d = single(RNG.normal(size=(COUNT, 3)) * 1.5), unit()
    d[:200] = np.eye(3)[RNG.integers(0, 3, 200)]
    low, high = np.tile([[-1.0, -0.5, 0.25]], (COUNT, 1)), np.tile([[0.5, 1.0, 1.25]], (COUNT, 1))
    found = wgsl("medium", "ray_box_interval", o, d, low, high, returns="vec2f")
    assert_same_interval(found, *medium.ray_box_interval(o, d, low, high), atol=1e-4)
    found = wgsl("medium", "ray_sphere_interval", o, d, low, 0.75, returns="vec2f")
    assert_same_interval(found, *medium.ray_sphere_interval(o, d, low, 0.75), atol=1e-4)


def test_ray_cone_interval(wgsl: Evaluate) -> None:
    o, d, axis = single(RNG.normal(size=(COUNT, 3)) * 1.5), unit(), unit()
    cosine = single(RNG.uniform(0.3, 0.99, COUNT))
    apex = np.zeros((COUNT, 3))
    # rays along the cone's own side meet it far away: their ends are not compared
    slanted = np.abs(np.einsum("ni,ni->n", d, axis) ** 2 - cosine**2) > 0.02
    o, d, axis, cosine, apex = (v[slanted] for v in (o, d, axis, cosine, apex))
    found = wgsl("medium", "ray_cone_interval", o, d, apex, axis, cosine, returns="vec2f")
    t0, t1 = medium.ray_cone_interval(o, d, apex, axis, cosine)
    assert_same_interval(found, t0, t1, atol=2e-3)


def test_ray_light_geometry(wgsl: Evaluate) -> None:
    o, light, d = single(RNG.normal(size=(COUNT, 3))), single(RNG.normal(size=(COUNT, 3))), unit()
    found = wgsl("medium", "ray_light_geometry", o, d, light, returns="vec2f")
    expected = np.stack(medium.ray_light_geometry(o, d, light), axis=1)
    np.testing.assert_allclose(found, expected, atol=3e-6)


def test_octahedron(wgsl: Evaluate) -> None:
    d = np.concatenate([unit(), np.eye(3), -np.eye(3)])
    square = wgsl("octahedron", "octahedron_encode", d, returns="vec2f")
    np.testing.assert_allclose(square, octahedron.octahedron_encode(d), atol=3e-7)
    back = wgsl("octahedron", "octahedron_decode", single(square), returns="vec3f")
    np.testing.assert_allclose(back, octahedron.octahedron_decode(single(square)), atol=1e-6)
    packed = wgsl("octahedron", "octahedron_pack16", d, returns="u32")
    # a coordinate next to a rounding border may fall to either side of it
    assert (packed == octahedron.octahedron_pack16(d)).mean() > 0.99


def test_octahedron_neighbour(wgsl: Evaluate) -> None:
    v, u = np.meshgrid(np.arange(6), np.arange(6), indexing="ij")
    cells = np.tile(np.stack([u, v], axis=-1).reshape(-1, 2), (4, 1))
    step = np.repeat([[1, 0], [-1, 0], [0, 1], [0, -1]], 36, axis=0)
    found = wgsl("octahedron", "octahedron_neighbour", cells, step, 6, returns="vec2i")
    np.testing.assert_array_equal(found, octahedron.octahedron_neighbour(cells, step, 6))


def test_hashes_are_the_same_bits(wgsl: Evaluate) -> None:
    values = np.concatenate([np.arange(2000), 2**32 - 1 - np.arange(2000)]).astype(np.uint32)
    hashed = wgsl("sampling", "pcg_hash", values, returns="u32")
    np.testing.assert_array_equal(hashed, sampling.pcg_hash(values))
    found = wgsl("sampling", "uniform_from_hash", hashed)
    np.testing.assert_array_equal(found, sampling.uniform_from_hash(hashed))
    x, y, frame = (RNG.integers(0, 4000, COUNT).astype(np.uint32) for _ in range(3))
    found = wgsl("sampling", "r2_noise", x, y, frame)
    np.testing.assert_array_equal(found, sampling.r2_noise(x, y, frame))


def test_orthonormal_frame(wgsl: Evaluate) -> None:
    n = unit()
    found = wgsl("sampling", "orthonormal_frame", n, returns="mat3x3f")
    expected = np.stack([*sampling.orthonormal_frame(n), n], axis=1)
    np.testing.assert_allclose(found, expected, atol=1e-5)


@pytest.mark.parametrize("name", tone.TONE_CURVES)
def test_tone_curves(wgsl: Evaluate, name: str) -> None:
    colours = single(2.0 ** RNG.uniform(-14.0, 8.0, (COUNT, 3)))
    colours[:4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.5, 0.0], [1e6, 1e5, 1.0]]
    curve = np.full(COUNT, list(tone.TONE_CURVES).index(name), dtype=np.uint32)
    stops = np.full(COUNT, 1.5)
    found = wgsl("tone", "tone_map", colours, stops, curve, returns="vec3f")
    np.testing.assert_allclose(found, tone.tone_map(colours, 1.5, name), atol=4e-5)


def test_tone_map_drops_what_is_not_finite(wgsl: Evaluate) -> None:
    bad = np.array([[np.nan, np.inf, -np.inf]] * 4)
    curve = np.arange(4, dtype=np.uint32)
    found = wgsl("tone", "tone_map", bad, np.zeros(4), curve, returns="vec3f")
    np.testing.assert_allclose(found, 0.0, atol=1e-6)


def test_colour(wgsl: Evaluate) -> None:
    from airlight.maths import colour

    c = single(RNG.random((COUNT, 3)))
    for name, truth in (("srgb_encode", colour.srgb_encode), ("srgb_decode", colour.srgb_decode)):
        found = wgsl("tone", name, c, returns="vec3f")
        np.testing.assert_allclose(found, truth(c), atol=2e-6)
    np.testing.assert_allclose(wgsl("tone", "luminance", c), colour.luminance(c), atol=1e-6)


def test_reduced_emission(wgsl: Evaluate) -> None:
    from airlight.maths.outgoing_light import reduced_emission

    fluence, indirect, whole = (single(RNG.random((COUNT, 3))) for _ in range(3))
    g = single(RNG.uniform(-0.9, 0.9, (COUNT, 3)))
    g[:50] = 0.0
    expected = reduced_emission(fluence, indirect, whole, g)
    found = wgsl("outgoing_light", "reduced_emission", fluence, indirect, whole, g, returns="vec3f")
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-7)
