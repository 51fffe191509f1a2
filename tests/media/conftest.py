"""Single scattering of a scene, for the tests of shafts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.lighting.lights import Lights
from airlight.media.media_image import MediaImage
from airlight.media.settings import MediaSettings

from .shaft_setups import BOX


@pytest.fixture
def scattered_once(gpu: Gpu, owned: Callable[[Any], Any]) -> Callable[..., np.ndarray]:
    """scattered_once(seen, **settings) -> (H, W, 3), W m^-2 sr^-1, in full resolution.

    `maps`: the sides of the shadow maps of directional and of local lights, texels.
    """

    def image(
        seen: Any,
        *,
        maps: tuple[int, int] = (512, 512),
        bounds: Any = BOX,
        frame: int = 0,
        **settings: Any,
    ) -> np.ndarray:
        scene = seen.scene
        low, high = (np.array(corner) for corner in bounds)
        lights = owned(Lights(gpu, scene.lights, None, maps))
        lights.encode(seen.commands, seen.meshes, scene.lights, None, low, high)
        given = {"shaft_resolution": "full", "march_resolution": "full", **settings}
        air = owned(MediaImage(gpu, scene, seen.size, lights, MediaSettings(**given)))
        air.solve(seen.commands, scene, low, high)
        air.encode(seen.commands, seen.view, lights, frame=frame)
        return np.asarray(seen.read(air.single_scatter))

    return image
