"""Single scattering against quadrature: directional, point and spot, without and with a blocker."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.reference.quadrature import (
    box_path,
    directional_single_scatter,
    henyey_greenstein,
    panels,
    point_single_scatter,
)
from airlight.scene.camera import Camera
from airlight.scene.lights import DirectionalLight, Light, PointLight, SpotLight
from airlight.scene.medium import Medium
from airlight.scene.mesh import Mesh
from airlight.scene.scene import Scene
from airlight.scene.shapes import quad

from .shaft_setups import BOX, SHEET_Y, TRAVEL, is_lit, unshaded

SIZE = (27, 18)
MAPS = (1024, 1024)
SIGMA_T, ALBEDO, G = np.array([0.15, 0.5, 1.2]), np.array([0.9, 0.6, 1.0]), 0.45
EYES = {"outside": (0.6, 0.4, 5.5), "inside": (0.5, 0.2, 1.6)}
SUN = DirectionalLight(TRAVEL, (3.0, 2.0, 1.0))
LIGHT = PointLight((0.3, 0.8, -0.2), (3.0, 2.0, 1.0))
SPOT = SpotLight((0.3, 1.4, -0.2), (-0.2, -1.0, 0.1), (3.0, 2.0, 1.0), 15.0, 28.0)
LIGHTS = {"directional": SUN, "point": LIGHT, "spot": SPOT}


def fog(eye: tuple[float, float, float], *lights: Light, sheet: bool = False) -> Scene:
    size = 40.0
    matrix = np.diag([size, 1.0, size, 1.0])
    matrix[:3, 3] = (-0.5 * size, SHEET_Y, 0.0)
    return Scene(
        meshes=(Mesh(quad(), world_from_object=matrix),) if sheet else (),
        lights=lights,
        medium=Medium(tuple(SIGMA_T), tuple(ALBEDO), (G, G, G), BOX),
        camera=Camera(eye, (0.0, 0.2, -1.0), fov_y_deg=60),
    )


def truth(light: Light, seen: Any, lit: Callable[..., np.ndarray], box: Any = BOX) -> np.ndarray:
    """(H, W, 3): panels over each eye ray; what bounds the ray is the sheet or the box."""
    d = seen.directions()
    eye = np.array(seen.scene.camera.position)
    entry, leave = box_path(eye, d, box)
    if seen.scene.meshes:
        with np.errstate(divide="ignore"):
            s = (SHEET_Y - eye[1]) / d[..., 1]
        hits = (s > 0) & (eye[0] + s * d[..., 0] < 0.0)
        leave = np.where(hits, np.clip(s, entry, leave), leave)
    x, w = panels(150, 2)
    t = entry[..., None] + (leave - entry)[..., None] * x
    p = eye + t[..., None] * d[..., None, :]
    travel, _, irradiance, path, color = unshaded(light, p, box)
    mu = -np.sum(travel * d[..., None, :], axis=-1)
    base = irradiance * henyey_greenstein(mu, G) * lit(light, p) * w
    depth = (t - entry[..., None] + path)[..., None] * SIGMA_T
    total = np.sum(base[..., None] * np.exp(-depth), axis=-2)
    return np.asarray(total * (leave - entry)[..., None] * SIGMA_T * ALBEDO * color)


def everywhere(_: Light, p: np.ndarray) -> np.ndarray:
    return np.ones(p.shape[:-1])


def l2(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


@pytest.mark.parametrize("eye", EYES.values(), ids=EYES.keys())
@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
def test_without_a_blocker(look: Any, scattered_once: Any, light: Light, eye: Any) -> None:
    seen = look(fog(eye, light), SIZE)
    image = scattered_once(seen, maps=MAPS)
    expected = truth(light, seen, everywhere)
    assert l2(image, expected) < 0.004
    np.testing.assert_allclose(image, expected, rtol=0.02, atol=2e-3 * expected.max())


def test_agrees_with_the_reference_functions(look: Any, scattered_once: Any) -> None:
    """The same truth once more from reference.quadrature, for one channel and an eye in the fog."""
    seen = look(fog(EYES["inside"], SUN), SIZE)
    image = scattered_once(seen, maps=MAPS)
    eye, d = np.array(EYES["inside"]), seen.directions()
    for k in range(3):
        expected = directional_single_scatter(
            eye, d, TRAVEL, SUN.irradiance[k], SIGMA_T[k], ALBEDO[k], G, BOX
        )
        np.testing.assert_allclose(image[..., k], expected, rtol=2e-3)
    seen = look(fog(EYES["inside"], LIGHT), SIZE)
    image = scattered_once(seen, maps=MAPS)
    length = box_path(eye, d, BOX)[1]
    expected = point_single_scatter(
        eye, d, length, LIGHT.position, LIGHT.intensity[1], SIGMA_T[1], ALBEDO[1], G
    )
    np.testing.assert_allclose(image[..., 1], expected, rtol=0.01)


@pytest.mark.parametrize("eye", EYES.values(), ids=EYES.keys())
@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
def test_the_shadow_of_a_half_plane(look: Any, scattered_once: Any, light: Light, eye: Any) -> None:
    seen = look(fog(eye, light, sheet=True), SIZE)
    image = scattered_once(seen, maps=MAPS)
    expected = truth(light, seen, is_lit)
    assert l2(image, expected) < 0.01
