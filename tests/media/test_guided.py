"""Reduced marching through sharp density, beside marching at full resolution."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.media.compositing.guided import GuidedUpsample
from airlight.rendering import render
from airlight.scene import (
    Camera,
    DirectionalLight,
    Emission,
    Material,
    Mesh,
    PointLight,
    Scene,
    Volume,
)
from airlight.scene.image import Image
from airlight.scene.shapes import quad

SIZE = (48, 40)
SMALL = {
    "resolution": 8,
    "shadow_resolution": 64,
    "lamp_resolution": 32,
    "surfels": 500,
    "sky_lights": 0,
}
POP = {**SMALL, "grid": 8}


def wisps() -> Scene:
    """Filaments a voxel thick before a floor and nothing."""
    rng = np.random.default_rng(4)
    density = np.zeros((20, 20, 20), np.float32)
    density[rng.random(density.shape) < 0.06] = 1.0
    floor = Mesh(quad(), Material(base_color=(0.5,) * 3, specular=0.0), np.diag([4, 1, 4, 1.0]))
    return Scene(
        meshes=(floor,),
        camera=Camera((0.3, 1.4, 4.0), (0.0, 0.9, 0.0), fov_y_deg=36.0),
        lights=(DirectionalLight((0.3, -1.0, -0.4), (3.0, 2.0, 1.0)),),
        volumes=(Volume((9.0, 12.0, 15.0), density, bounds=((-1, 0.1, -1), (1, 2.1, 1))),),
    )


def drawn(technique: str, settings: dict[str, object], scene: Scene | None = None) -> Image:
    return render(scene or wisps(), technique, SIZE, settings=settings, samples=1)


def away(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.linalg.norm(one - other) / np.linalg.norm(other))


@pytest.mark.parametrize(("reduced", "limit"), [("half", 0.08), ("quarter", 0.12)])
def test_smoke_is_as_sharp_as_at_full_resolution(reduced: str, limit: float) -> None:
    """By depth alone the share that is hidden is .27 off at half, .44 at quarter resolution."""
    assert GuidedUpsample
    full = drawn("pop", {**POP, "march": "full"}).layers
    got = drawn("pop", {**POP, "march": reduced}).layers
    assert away(1.0 - got["transmittance"], 1.0 - full["transmittance"]) < 0.02
    assert away(got["scattered"], full["scattered"]) < limit


def test_in_composed_air_too() -> None:
    light = PointLight((0.0, 3.0, 1.0), (9.0,) * 3)
    scene = Scene(
        meshes=wisps().meshes, camera=wisps().camera, lights=(light,), volumes=wisps().volumes
    )
    settings = {**SMALL, "shafts": "off", "iterations": 4}
    full = drawn("lpv-scatter", {**settings, "march_resolution": "full"}, scene).layers
    got = drawn("lpv-scatter", {**settings, "march_resolution": "half"}, scene).layers
    assert away(1.0 - got["transmittance"], 1.0 - full["transmittance"]) < 0.02
    assert away(got["multiple_scatter"], full["multiple_scatter"]) < 0.12
    clear = full["transmittance"].min(axis=-1) >= 1.0
    assert clear.any()
    assert got["multiple_scatter"][clear].max() < 0.02 * got["multiple_scatter"].max()


def test_fire_does_not_follow_the_opacity_of_smoke() -> None:
    """Flames half out of their smoke had black lines at its border, .72 of their light."""
    z, y, x = np.meshgrid(*((np.arange(24) + 0.5) / 12.0 - 1.0,) * 3, indexing="ij")
    smoke = (x * x + y * y + z * z < 0.5).astype(np.float32)
    glow = ((x + 0.65) ** 2 + y * y + z * z < 0.06).astype(np.float32)
    volume = Volume((5.0,) * 3, smoke, emission=Emission((1.0, 0.5, 0.2), grid=glow))
    scene = Scene(volumes=(volume,), camera=Camera((0.0, 0.3, 6.0), (0, 0, 0), fov_y_deg=24.0))
    full, half = (
        drawn("single", {"shafts": "off", "march_resolution": r}, scene).layers["multiple_scatter"]
        for r in ("full", "half")
    )
    # Measured 7e-8, as pixels of flames follow their own rays; more where no texel sees a flame.
    assert away(half, full) < 1e-3
