"""No air and no light makes single scattering negative, infinite or undefined."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.lighting.lights import Lights
from airlight.media.media_image import MediaImage
from airlight.media.settings import MediaSettings
from airlight.scene import (
    Camera,
    DirectionalLight,
    Medium,
    Mesh,
    PointLight,
    Scene,
    SpotLight,
    Volume,
)

SIZE = (16, 12)
EYE = (0.5, 0.25, 1.0)
BOX = ((-1.0, -1.0, -2.0), (1.0, 1.0, 2.0))
RGB = (1.0, 1.0, 1.0)
LIGHTS = (
    DirectionalLight((0.0, 0.0, -1.0), RGB),  # along the middle ray
    DirectionalLight((0.0, -1.0, 0.0), RGB),
    PointLight(EYE, RGB),  # in the eye
    PointLight((0.5, 0.25, -1.0), RGB),  # on the middle ray
    PointLight((1.0, 1.0, 2.0), RGB),  # on the medium's corner
    SpotLight((0.5, 0.25, 3.0), (0.0, 0.0, -1.0), RGB, 5.0, 5.0),  # behind the eye, no penumbra
)


@pytest.mark.parametrize(
    ("scheme", "has_grid"),
    [("minmax", False), ("volumes", False), ("jitter", False), ("minmax", True)],
)
@pytest.mark.parametrize("sigma_t", [(0.0, 1e-6, 1e-3), (1.0, 30.0, 1e4)])
def test_everything_is_finite(
    gpu: Gpu,
    look: Any,
    owned: Any,
    square: Callable[..., Mesh],
    scheme: str,
    has_grid: bool,
    sigma_t: Any,
) -> None:
    how = {"albedo": (1.0, 0.0, 0.5), "g": (0.99, -0.99, 0.0), "bounds": BOX}
    air: dict[str, Any] = {"medium": Medium(sigma_t, **how)}
    if has_grid:
        density = np.zeros((3, 4, 5), np.float32)
        density[1:, 2:] = 1.0
        air = {"volumes": (Volume(sigma_t, density, **how),)}
    sheet = square((0.0, 0.3, 0.0), (0.4, 0.1, 0), (0, 0, -0.7))
    camera = Camera(EYE, (0.5, 0.25, -1.0), fov_y_deg=70)
    scene = Scene(meshes=(sheet,), lights=LIGHTS, camera=camera, **air)
    seen = look(scene, SIZE)
    low, high = (np.array(corner) for corner in BOX)
    lights = owned(Lights(gpu, scene.lights, None, (128, 64)))
    lights.encode(seen.commands, seen.meshes, scene.lights, None, low, high)
    settings = MediaSettings(shafts=scheme, shaft_resolution="full")
    drawn = owned(MediaImage(gpu, scene, SIZE, lights, settings))
    drawn.solve(seen.commands, scene, low, high)
    drawn.encode(seen.commands, seen.view, lights)
    for layer in (drawn.single_scatter, drawn.transmittance):
        image = seen.read(layer)
        assert np.isfinite(image).all()
        assert image.min() >= 0.0
