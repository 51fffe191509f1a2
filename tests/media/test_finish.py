"""One pass does what upsampling, transmittance and composing do one after the other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.gpu.memory import Texture
from airlight.media.compositing.compose import Compose
from airlight.media.compositing.finish import Finish, MediaLayers, Reduced, can_finish
from airlight.media.compositing.transmittance import Transmittance
from airlight.media.compositing.upsample import Upsample
from airlight.media.gpu_media import GpuMedia
from airlight.media.rays import Rays
from airlight.scene import Camera, Medium, Mesh, Scene

SIZE = (37, 23)
LAYERS = ("multiple", "transmittance", "single")


@pytest.mark.parametrize("has_sky", [False, True])
def test_it_is_what_the_passes_make(
    gpu: Gpu, look: Any, square: Callable[..., Mesh], has_sky: bool
) -> None:
    assert can_finish(gpu) or gpu.paths.stored_screens
    post = square((-10, 0, 0.2), (10, 0, 0), (0, 20, 0))
    medium = Medium((0.4, 0.9, 1.6), bounds=((-1.0, -0.8, -1.2), (1.0, 1.1, 1.3)))
    camera = Camera((0.3, 0.2, 4.0), (0, 0, -1), fov_y_deg=50)
    seen = look(Scene(meshes=(post,), camera=camera, medium=medium), SIZE)
    air = GpuMedia(gpu, seen.scene, light_count=0)
    air.update(seen.commands, seen.scene, *seen.scene.bounds)
    rays = Rays(gpu, SIZE, 2)
    rays.encode(seen.commands, seen.view)
    distance = seen.read(rays.picked)[..., :1]
    rng = np.random.default_rng(7)

    def texture(name: str, *, is_reduced: bool = False) -> Texture:
        width, height = rays.reduced if is_reduced else SIZE
        values = rng.random((height, width, 4)).astype(np.float32)
        if is_reduced:
            values[..., 3:] = distance
        made = Texture(gpu, name, (width, height), "rgba32float", target=True, written=True)
        made.write(values)
        return made

    reduced, skylit = (texture(name, is_reduced=True) for name in ("multiple", "sky"))
    shafts, direct, indirect = (texture(name) for name in ("shafts", "direct", "indirect"))
    surfaces, depth = {"direct": direct, "indirect": indirect}, seen.view.gbuffer.depth
    apart, at_once = (
        {
            name: Texture(gpu, name, SIZE, "rgba32float", target=True, written=True)
            for name in LAYERS
        }
        for _ in range(2)
    )
    one, alpha = Compose(gpu, SIZE), direct.read()[..., 3]
    Upsample(gpu).encode(seen.commands, rays, depth, reduced, apart["multiple"])
    Transmittance(gpu, air).encode(seen.commands, rays, depth, apart["transmittance"])
    if has_sky:
        upsample = Upsample(gpu, is_added=True)
        upsample.encode(seen.commands, rays, depth, skylit, apart["single"], shafts)
    else:
        apart["single"] = at_once["single"] = shafts
    one.encode(seen.commands, **surfaces, transmittance=apart["transmittance"])
    Finish(gpu, air, has_sky=has_sky).encode(
        seen.commands,
        rays,
        depth,
        Reduced(reduced, shafts, skylit),
        MediaLayers((direct, indirect), **at_once),
    )
    # Along the image, rays are interpolated between vertices: a few units in the last place.
    pairs = [(apart[n], at_once[n]) for n in LAYERS]
    pairs += list(zip(one.layers, (direct, indirect), strict=True))
    for expected, got in pairs:
        np.testing.assert_allclose(seen.read(got)[..., :3], seen.read(expected)[..., :3], rtol=2e-5)
    np.testing.assert_array_equal(direct.read()[..., 3], alpha)
