"""Light volumes against quadrature behind an open sheet, and lit intervals among clutter."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.errors import SettingsError
from airlight.gpu.device import Gpu
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

from .shaft_setups import BOX, RGB, TRAVEL, compressed_l2, unshaded

SIZE = (48, 36)
SIGMA_T, ALBEDO, G = np.array([0.15, 0.5, 1.2]), np.array([0.9, 0.6, 1.0]), 0.45
LIGHTS: dict[str, Light] = {
    "directional": DirectionalLight(TRAVEL, RGB),
    "point": PointLight((0.3, 1.2, -0.2), RGB),
    "spot": SpotLight((0.3, 1.4, -0.2), (-0.2, -1.0, 0.1), RGB, 15.0, 28.0),
}
EYES = {"outside": (0.6, 0.9, 5.5), "inside": (0.5, 0.2, 1.6)}
SHEET_Y = 0.6  # of a square from -0.7 to 0.7 in x and z


def fog(light: Light, eye: Any, *meshes: Mesh) -> Scene:
    medium = Medium(tuple(SIGMA_T), tuple(ALBEDO), (G, G, G), BOX)
    camera = Camera(eye, (0.0, 0.2, -1.0), fov_y_deg=50)
    return Scene(meshes=meshes, lights=(light,), medium=medium, camera=camera)


def truth(light: Light, seen: Any) -> np.ndarray:
    """(H, W, 3): panels over each eye ray up to the box or the sheet, lit where the sheet lets."""
    d, eye = seen.directions(), np.array(seen.scene.camera.position)
    entry, leave = box_path(eye, d, BOX)
    with np.errstate(divide="ignore"):
        s = (SHEET_Y - eye[1]) / d[..., 1]
    hits = (s > 0) & np.all(np.abs(eye[::2] + s[..., None] * d[..., ::2]) < 0.7, axis=-1)
    leave = np.where(hits, np.clip(s, entry, leave), leave)
    x, w = panels(200, 2)
    t = entry[..., None] + (leave - entry)[..., None] * x
    p = eye + t[..., None] * d[..., None, :]
    travel, r, gain, path, color = unshaded(light, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        back = (p[..., 1] - SHEET_Y) / travel[..., 1]
        at = p - back[..., None] * travel
    gain = np.where((back > 0) & (back < r) & np.all(np.abs(at[..., ::2]) < 0.7, axis=-1), 0, gain)
    mu = -np.sum(travel * d[..., None, :], axis=-1)
    depth = (t - entry[..., None] + path)[..., None] * SIGMA_T
    total = np.sum((gain * henyey_greenstein(mu, G) * w)[..., None] * np.exp(-depth), axis=-2)
    return np.asarray(total * (leave - entry)[..., None] * SIGMA_T * ALBEDO * color)


@pytest.mark.parametrize(
    ("light", "eye"),
    [
        ("directional", "outside"),
        ("directional", "inside"),
        ("point", "inside"),
        ("spot", "outside"),
    ],
)
def test_agrees_with_quadrature(
    look: Any, scattered_once: Any, square: Callable[..., Mesh], light: str, eye: str
) -> None:
    seen = look(
        fog(LIGHTS[light], EYES[eye], square((0, SHEET_Y, 0), (0.7, 0, 0), (0, 0, -0.7))), SIZE
    )
    image = scattered_once(seen, shafts="volumes", maps=(256, 256))
    expected = truth(LIGHTS[light], seen)
    assert compressed_l2(image, expected) < 0.01


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
def test_no_pixel_leaks_among_clutter(
    look: Any, scattered_once: Any, square: Callable[..., Mesh], light: Light
) -> None:
    """A crack between faces is one pixel far off; steps at single texels make thousands of them."""
    rng = np.random.default_rng(5)
    sheets = [
        square(rng.uniform(-1.8, 1.6, 3), rng.uniform(-0.5, 0.5, 3), rng.uniform(-0.5, 0.5, 3))
        for _ in range(25)
    ]
    seen = look(fog(light, EYES["inside"], *sheets), SIZE)
    exact = scattered_once(seen, shafts="minmax", maps=(64, 64), shaft_nodes=65536)
    image = scattered_once(seen, shafts="volumes", maps=(64, 64), volume_tolerance=0.0)
    assert compressed_l2(image, exact) < 0.01
    np.testing.assert_allclose(image, exact, atol=0.1 * exact.max())


def test_half_resolution_is_near_the_full_one(
    look: Any, scattered_once: Any, square: Callable[..., Mesh]
) -> None:
    sheet = square((0, SHEET_Y, 0), (0.7, 0, 0), (0, 0, -0.7))
    seen = look(fog(LIGHTS["directional"], EYES["outside"], sheet), SIZE)
    full = scattered_once(seen, shafts="volumes", maps=(256, 256))
    half = scattered_once(seen, shafts="volumes", maps=(256, 256), shaft_resolution="half")
    assert 0.0 < compressed_l2(half, full) < 0.15
    assert half.sum() == pytest.approx(full.sum(), rel=0.02)


def test_other_air_is_refused(look: Any, scattered_once: Any) -> None:
    scene = fog(LIGHTS["point"], EYES["inside"])
    ball = Volume((1.0, 1.0, 1.0), shape="sphere", bounds=BOX)
    seen = look(dataclasses.replace(scene, volumes=(ball,)), SIZE)
    with pytest.raises(SettingsError) as told:
        scattered_once(seen, shafts="volumes", maps=(16, 16))
    assert str(told.value) == (
        "shafts = 'volumes' draws one homogeneous box, and the scene has other media. "
        "Use shafts = 'minmax', the same light by another method"
    )


def test_a_device_that_cannot_add_floats_is_told(
    gpu: Gpu, look: Any, scattered_once: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gpu, "features", [])
    seen = look(fog(LIGHTS["point"], EYES["inside"]), SIZE)
    with pytest.raises(SettingsError, match="adds up in a 32-bit float target"):
        scattered_once(seen, shafts="volumes", maps=(16, 16))
