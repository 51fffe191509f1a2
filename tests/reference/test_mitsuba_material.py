"""How far `principled`, which stands in where our own model cannot, is from that model."""

from __future__ import annotations

import math

import numpy as np
import pytest

from airlight.reference import mitsuba
from airlight.reference.mitsuba_material import PRINCIPLED, is_absent, is_masked
from airlight.reference.mitsuba_textures import linear_pixels, unfolded
from airlight.scene import Camera, Environment, Geometry, Material, Mesh, Scene, Texture


def reflectance(roughness: float, base: float, cosine: float) -> float:
    """Directional-hemispherical reflectance of glTF's dielectric, by quadrature."""
    n = 400
    mu = (np.arange(n) + 0.5) / n
    phi = (np.arange(2 * n) + 0.5) / n * math.pi
    mu, phi = np.meshgrid(mu, phi)
    sine = np.sqrt(1 - mu**2)
    light = np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)
    view = np.array([math.sqrt(1 - cosine**2), 0.0, cosine])
    half = light + view
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    fresnel = 0.04 + 0.96 * (1 - half @ view) ** 5
    a2 = roughness**4
    d = a2 / (math.pi * (half[..., 2] ** 2 * (a2 - 1) + 1) ** 2)
    v = 0.5 / (mu * np.sqrt(cosine**2 * (1 - a2) + a2) + cosine * np.sqrt(mu**2 * (1 - a2) + a2))
    f = (1 - fresnel) * base / math.pi + fresnel * d * v
    return float((f * mu).mean() * 2 * math.pi)


@pytest.mark.needs("mitsuba")
@pytest.mark.parametrize(
    ("roughness", "cosine", "low", "high"),
    [(1.0, 1.0, 1.05, 1.1), (1.0, 0.3, 1.15, 1.25), (0.6, 1.0, 1.02, 1.07), (0.3, 0.3, 1.0, 1.06)],
)
def test_principled_differs_by_as_much_as_said(roughness, cosine, low, high) -> None:
    """A plane under a white sky shows its reflectance."""
    x = np.array([[-50, 0, -50], [-50, 0, 50], [50, 0, 50], [50, 0, -50]], np.float32)
    plane = Geometry(x, np.array([[0, 1, 2], [0, 2, 3]], np.uint32))
    material = Material(base_color=(0.5,) * 3, roughness=roughness)
    position = (0.0, cosine * 5, math.sqrt(1 - cosine**2) * 5)
    camera = Camera(position=position, target=(0, 0, 0), up=(0, 0.1, -1), fov_y_deg=0.5)
    scene = Scene(meshes=(Mesh(plane, material),), environment=Environment(), camera=camera)
    image = mitsuba.render(scene, size=(8, 8), spp=512, max_depth=2, variant="scalar_rgb")
    assert low < image.radiance.mean() / reflectance(roughness, 0.5, cosine) < high
    assert image.stats["approximations"] == [PRINCIPLED]


def test_what_is_masked_and_what_is_absent() -> None:
    pixels = np.full((2, 2, 4), 255, np.uint8)
    square = Geometry(
        np.eye(3, dtype=np.float32),
        np.array([[0, 1, 2]], np.uint32),
        uvs=np.zeros((3, 2), np.float32),
    )
    opaque = Material(base_color_texture=Texture(pixels), alpha_cutoff=0.5)
    assert not is_masked(opaque, square) and not is_absent(opaque)
    holed = pixels.copy()
    holed[0, 0, 3] = 0
    assert is_masked(Material(base_color_texture=Texture(holed), alpha_cutoff=0.5), square)
    assert not is_masked(Material(base_color_texture=Texture(holed)), square)
    assert is_absent(Material(alpha=0.4, alpha_cutoff=0.5))


def test_a_mirrored_axis_beside_another_is_unfolded() -> None:
    pixels = np.arange(8, dtype=np.uint8).reshape(1, 2, 4)
    texture = Texture(pixels, is_srgb=False, wrap=("mirror", "repeat"))
    flat = unfolded(texture, linear_pixels(texture))
    assert flat.shape == (1, 4, 3)
    np.testing.assert_array_equal(flat[0, 3], flat[0, 0])
    np.testing.assert_array_equal(flat[0, 2], flat[0, 1])
