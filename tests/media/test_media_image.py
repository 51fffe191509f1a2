"""The facade: what it fills, at reduced resolutions, in several media and in none."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.lighting.lights import Lights
from airlight.media.compositing.finish import can_finish
from airlight.media.image_textures import Expected
from airlight.media.media_image import MediaImage
from airlight.media.settings import MediaSettings
from airlight.media.shafts import image as shaft_image
from airlight.rendering import Renderer
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Medium,
    Mesh,
    PointLight,
    Scene,
    Volume,
)

from .shaft_setups import compressed_l2

SIZE = (44, 32)
"""Rows at which shafts fit between sites, but not between reduced texels."""
BOX = ((-2.0, -1.5, -2.0), (2.0, 2.0, 2.0))
LIGHT = PointLight((0.3, 1.2, -0.2), (3.0, 2.0, 1.0))
SUN = DirectionalLight((0.35, -0.8, -0.3), (3.0, 2.0, 1.0))


@pytest.fixture
def foggy(square: Callable[..., Mesh]) -> Scene:
    """A box of air with a lamp and a sun, a post before it and a sheet in it."""
    post = square((-0.8, 0, 3.5), (0.15, 0, 0), (0, 3, 0))
    sheet = square((-0.7, 0.6, 0.0), (0.7, 0, 0), (0, 0, -0.8))
    return Scene(
        meshes=(post, sheet),
        lights=(LIGHT, SUN),
        medium=Medium((0.2, 0.4, 0.8), bounds=BOX),
        camera=Camera((0.6, 0.4, 5.5), (0.0, 0.2, -1.0), fov_y_deg=45),
    )


def drawn(gpu: Gpu, seen: Any, owned: Callable[[Any], Any], **settings: Any) -> MediaImage:
    scene = seen.scene
    low, high = (np.array(corner) for corner in BOX)
    lights = owned(Lights(gpu, scene.lights, None, (512, 256)))
    lights.encode(seen.commands, seen.meshes, scene.lights, None, low, high)
    air: MediaImage = owned(MediaImage(gpu, scene, seen.size, lights, MediaSettings(**settings)))
    air.solve(seen.commands, scene, low, high)
    air.encode(seen.commands, seen.view, lights)
    return air


def full(gpu: Gpu, seen: Any, owned: Callable[[Any], Any]) -> np.ndarray:
    air = drawn(gpu, seen, owned, shaft_resolution="full", march_resolution="full")
    return np.asarray(seen.read(air.single_scatter))


@pytest.fixture
def as_if_large(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small images are reduced as large ones are."""
    monkeypatch.setattr(shaft_image, "COARSE_TEXEL", np.inf)


def test_small_images_are_drawn_whole(gpu: Gpu, look: Any, owned: Any, foggy: Scene) -> None:
    seen = look(foggy, SIZE)
    exact = full(gpu, seen, owned)
    small = seen.read(drawn(gpu, seen, owned).single_scatter)
    np.testing.assert_allclose(small[..., :3], exact[..., :3], rtol=1e-3, atol=1e-6)
    never = seen.read(drawn(gpu, seen, owned, shaft_contrast=1.0).single_scatter)
    assert compressed_l2(never[..., :3], exact[..., :3]) > 0.01


@pytest.mark.usefixtures("as_if_large")
def test_reduced_images_are_near_the_full_one(
    gpu: Gpu, look: Any, owned: Any, foggy: Scene
) -> None:
    seen = look(foggy, SIZE)
    exact = full(gpu, seen, owned)
    for name, ceiling in (("half", 0.06), ("quarter", 0.15)):
        reduced = seen.read(drawn(gpu, seen, owned, shaft_resolution=name).single_scatter)
        assert compressed_l2(reduced, exact) < ceiling
        # The post is nearer than the air: it stays black to its very edge.
        near_m = seen.view.clip_from_world[2, 3]
        post = seen.view.gbuffer.depth.read() > near_m / 3.0
        assert post.any()
        assert np.all(reduced[post] < 0.02 * exact.mean())


def test_two_media_are_as_one_of_their_sum(gpu: Gpu, look: Any, owned: Any, foggy: Scene) -> None:
    assert foggy.medium is not None
    one = full(gpu, look(foggy, SIZE), owned)
    share = tuple(0.3 * s for s in foggy.medium.sigma_t)
    rest = tuple(0.7 * s for s in foggy.medium.sigma_t)
    two = dataclasses.replace(
        foggy, medium=Medium(share, bounds=BOX), volumes=(Volume(rest, shape="box", bounds=BOX),)
    )
    assert compressed_l2(full(gpu, look(two, SIZE), owned), one) < 0.01


def test_a_solved_volume_has_no_shafts_but_takes_light(
    gpu: Gpu, look: Any, owned: Any, foggy: Scene
) -> None:
    assert foggy.medium is not None
    ball = Volume((5.0, 5.0, 5.0), shape="sphere", bounds=((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)))
    scene = dataclasses.replace(foggy, medium=None, volumes=(ball,))
    seen = look(scene, SIZE)
    lights = owned(Lights(gpu, scene.lights, None, (64, 64)))
    low, high = (np.array(corner) for corner in BOX)
    lights.encode(seen.commands, seen.meshes, scene.lights, None, low, high)
    air = owned(MediaImage(gpu, scene, SIZE, lights, expected=Expected(solved=(ball,))))
    air.solve(seen.commands, scene, low, high)
    air.encode(seen.commands, seen.view, lights)
    assert not seen.read(air.single_scatter).any()
    assert seen.read(air.transmittance).min() < 0.02


def test_without_air_nothing_happens(gpu: Gpu, look: Any, owned: Any, foggy: Scene) -> None:
    seen = look(dataclasses.replace(foggy, medium=None), SIZE)
    air = drawn(gpu, seen, owned)
    air.compose(seen.commands, seen.view)
    assert not seen.read(air.single_scatter).any()
    assert not seen.read(air.multiple_scatter).any()
    assert np.all(seen.read(air.transmittance) == 1.0)


@pytest.mark.usefixtures("as_if_large")
def test_pixels_are_redrawn_where_texels_differ(
    gpu: Gpu, look: Any, owned: Any, foggy: Scene
) -> None:
    seen = look(foggy, SIZE)
    exact = full(gpu, seen, owned)
    off = [
        np.abs(seen.read(drawn(gpu, seen, owned, shaft_contrast=c).single_scatter) - exact).sum()
        for c in (1.0, 0.3, 0.0)
    ]
    assert off[0] > 2.0 * off[1] > 0.0
    # With no difference allowed every pixel is its own.
    assert off[2] < 1e-6 * exact.sum()


def test_surfaces_are_where_the_last_image_left_them(
    gpu: Gpu, foggy: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the view's layers where one pass finished, else apart: interleaved."""
    encode = MediaImage.encode

    def in_passes(self: MediaImage, *args: Any, **given: Any) -> None:
        encode(self, *args, **{**given, "is_composed": False})

    scene = dataclasses.replace(foggy, environment=Environment((0.3, 0.4, 0.5)))
    aside = dataclasses.replace(foggy.camera, position=(-1.5, 0.9, 5.0))
    settings = {
        "resolution": 4,
        "shadow_resolution": 64,
        "lamp_resolution": 32,
        "sky_lights": 4,
        "sky_resolution": 8,
        "surfels": 100,
    }
    with Renderer(scene, "single", SIZE, settings=settings) as renderer:
        technique, expected = renderer.technique, []
        for camera in (foggy.camera, aside):
            expected.append(renderer.frame(camera=camera).layers["direct"])
            is_there = technique.layers(renderer.view)["direct"] is renderer.view.layers.direct
            assert is_there == can_finish(renderer.gpu)
        with monkeypatch.context() as patched:
            patched.setattr(MediaImage, "encode", in_passes)
            apart = renderer.frame(camera=foggy.camera).layers["direct"]
            assert technique.layers(renderer.view)["direct"] is not renderer.view.layers.direct
        after = renderer.frame(camera=aside).layers["direct"]
    np.testing.assert_allclose(apart, expected[0], rtol=2e-5)
    np.testing.assert_array_equal(after, expected[1])


def test_reduced_images_are_those_that_are_written(gpu: Gpu, owned: Any, foggy: Scene) -> None:
    lights = owned(Lights(gpu, foggy.lights, None, (64, 64)))
    cases = (
        ({"has_lattice": True}, {"single", "multiple"}),
        ({"has_lattice": True, "has_sky": True}, {"single", "multiple", "sky"}),
        ({}, {"single"}),
    )
    for given, names in cases:
        air = owned(MediaImage(gpu, foggy, SIZE, lights, expected=Expected(**given)))
        assert set(air.textures.reduced) == names
