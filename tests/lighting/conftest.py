"""Images of small scenes, and the world points that their pixels see."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.rendering import render
from airlight.scene import Camera
from airlight.scene.image import Image

SIZE = (64, 48)
SMALL = {
    "resolution": 8,
    "shadow_resolution": 512,
    "lamp_resolution": 256,
    "sky_lights": 64,
    "sky_resolution": 32,
    "surfels": 4000,
}


@pytest.fixture
def rendered(gpu: Any) -> Callable[..., Image]:
    """image(scene, technique) -> Image of 64 x 48, one sample, small maps."""

    def make(scene: Any, technique: str = "direct", **settings: Any) -> Image:
        return render(scene, technique, SIZE, settings={**SMALL, **settings}, samples=1)

    return make


@pytest.fixture
def seen_points(camera_rays: Any) -> Callable[[Image, Camera], np.ndarray]:
    """seen_points(image, camera) -> (H, W, 3) metres; infinite where nothing is."""

    def points(image: Image, camera: Camera) -> np.ndarray:
        rays = camera_rays(camera, SIZE)
        return np.array(camera.position) + rays * image.layers["depth"][..., None]

    return points
