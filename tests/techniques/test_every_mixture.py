"""Every technique draws every mixture of light kinds and media, or says in words why not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from airlight import Renderer
from airlight.errors import SettingsError
from airlight.gpu.device import Gpu
from airlight.scene import (
    Camera,
    DirectionalLight,
    Environment,
    Light,
    Medium,
    Mesh,
    PointLight,
    PointLights,
    Scene,
    SpotLight,
    Volume,
)
from airlight.scene.material import Material
from airlight.scene.shapes import box, quad
from airlight.techniques import TECHNIQUES

LIGHTS: dict[str, tuple[Light, ...]] = {
    "sun": (DirectionalLight((0.3, -1.0, -0.4), (5.0, 5.0, 5.0)),),
    "point": (PointLight((1.0, 2.0, 1.0), (8.0, 8.0, 8.0)),),
    "spot": (SpotLight((-1.0, 2.5, 1.0), (0.4, -1.0, -0.4), (9.0, 9.0, 9.0)),),
}
FOG = Medium((0.1, 0.1, 0.1))
SMOKE = Volume(
    (1.0, 1.0, 1.0),
    density=np.random.default_rng(1).random((5, 6, 4)).astype(np.float32),
    bounds=((-1.0, 0.0, -1.0), (1.0, 2.0, 1.0)),
)
BALL = Volume((2.0, 2.0, 2.0), shape="sphere", bounds=((0.5, 0.0, 0.5), (1.5, 1.0, 1.5)))
MEDIA: dict[str, dict[str, Any]] = {
    "fog": {"medium": FOG},
    "smoke": {"volumes": (SMOKE,)},
    "fog and smoke": {"medium": FOG, "volumes": (SMOKE,)},
    "fog, smoke and ball": {"medium": FOG, "volumes": (SMOKE, BALL)},
}
SKY = Environment((0.2, 0.3, 0.4))
SMALL: dict[str, dict[str, Any]] = {
    "pop": {
        "grid": 6,
        "ordinates": 4,
        "virtual_lights": 4,
        "virtual_resolution": 16,
        "surfels": 4000,
    },
}
SURFACES = {"resolution": 8, "shadow_resolution": 128, "lamp_resolution": 64, "surfels": 4000}
SURFACES |= {"sky_lights": 8, "sky_resolution": 16}
ALL_LIGHTS = tuple(light for lights in LIGHTS.values() for light in lights)
SOME_LIGHTS = ((), LIGHTS["sun"], (*LIGHTS["point"], *LIGHTS["spot"]), ALL_LIGHTS)
SCHEMES: list[dict[str, Any]] = [
    {},
    {"scheme": "split"},
    {"scheme": "paper"},
    {"virtual_grids": "radial"},
]


def mixture(lights: tuple[Light, ...], media: str, **more: Any) -> Scene:
    floor = Mesh(quad(), Material(), np.diag([4.0, 1.0, 4.0, 1.0]))
    camera = Camera((0.0, 1.0, 4.0), (0.0, 1.0, 0.0))
    return Scene((floor, Mesh(box(), Material())), lights, camera=camera, **MEDIA[media], **more)


def check(scene: Scene, technique: str, settings: dict[str, Any]) -> None:
    with Renderer(scene, technique, size=(16, 16), settings=settings) as renderer:
        for _ in range(2):
            radiance = renderer.frame().radiance
            assert np.isfinite(radiance).all()
        assert (radiance.max() > 0.0) == bool(scene.lights or scene.environment)


def small(technique: str) -> dict[str, Any]:
    return SMALL.get(technique, SURFACES)


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_pop_takes_every_light_through_all_media_at_once(gpu: Gpu, scheme: dict[str, Any]):
    check(mixture(ALL_LIGHTS, "fog, smoke and ball"), "pop", {**SMALL["pop"], **scheme})


@pytest.mark.parametrize("technique", sorted(TECHNIQUES))
def test_every_technique_takes_every_light_through_fog_and_smoke(gpu: Gpu, technique: str):
    check(mixture(ALL_LIGHTS, "fog and smoke", environment=SKY), technique, small(technique))


@pytest.mark.slow
@pytest.mark.parametrize("technique", sorted(TECHNIQUES))
@pytest.mark.parametrize("media", MEDIA)
@pytest.mark.parametrize("sky", [None, SKY], ids=["black", "sky"])
def test_every_mixture(gpu: Gpu, technique: str, media: str, sky: Environment | None):
    for lights in SOME_LIGHTS:
        for scheme in SCHEMES if technique == "pop" and lights is ALL_LIGHTS else [{}]:
            scene = mixture(lights, media, environment=sky)
            check(scene, technique, {**small(technique), **scheme})


@pytest.mark.slow
@pytest.mark.parametrize("media", MEDIA)
def test_lights_by_the_thousand_are_taken_among_all_media(gpu: Gpu, media: str):
    group = PointLights(np.ones((3, 3), np.float32), np.ones((3, 3), np.float32))
    for technique in TECHNIQUES:
        check(mixture(ALL_LIGHTS, media, light_groups=(group,)), technique, small(technique))


def test_a_scheme_of_one_medium_says_which_it_does_not_know(gpu: Gpu):
    with pytest.raises(SettingsError, match="only one medium that fills the lattice"):
        Renderer(
            mixture(ALL_LIGHTS, "fog and smoke"),
            "lpv-scatter",
            size=(16, 16),
            settings={"scheme": "deposit", "resolution": 8},
        )
