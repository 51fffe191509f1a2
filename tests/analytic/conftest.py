"""Every technique before scenes whose answer is known; with --slow, Mitsuba too.

Mitsuba stands in line so that the questions themselves are checked: what the truth fails is a
wrong question.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from airlight.rendering import Renderer
from airlight.scene import Camera, Scene
from airlight.scene.image import Image
from airlight.techniques import TECHNIQUES, technique_settings

SMALL = {
    "resolution": 16,
    "shadow_resolution": 1024,
    "lamp_resolution": 256,
    "map_resolution": 128,
    "sky_lights": 64,
    "sky_resolution": 48,
    "surfels": 30_000,
    "shaft_resolution": "full",
    "march_resolution": "full",
    "march": "full",
}
MITSUBA = "mitsuba"

BASELINES = {
    "lpv-march": "it marches indirect light alone, as Billeter2012's Fig. 5 does",
    "lpv-sum": "it counts indirect light in air that it never takes from the surfaces",
}
"""Techniques whose air is wrong by design: they are there to be compared with."""

ALIKE = {"single": "direct", "pop": "direct", "lpv-march": "lpv", "lpv-sum": "lpv", "auto": "lpv"}
"""Techniques that are another one where there is no air, which test_surfaces.py holds."""


@dataclasses.dataclass(frozen=True)
class Judged:
    """One technique, or Mitsuba."""

    name: str

    @property
    def is_sharp(self) -> bool:
        """Whether air is drawn in every pixel; `auto` takes its half resolution for granted."""
        if self.name == MITSUBA:
            return True
        return "shaft_resolution" in _known(self.name)

    def image(
        self, scene: Scene, size: tuple[int, int] = (24, 24), spp: int = 256, **settings: Any
    ) -> Image:
        """The scene in `size` pixels, one sample each: analytic answers are of pixel centres."""
        return self.images(scene, [scene.camera], size, spp, **settings)[0]

    def images(
        self,
        scene: Scene,
        cameras: Sequence[Camera],
        size: tuple[int, int] = (24, 24),
        spp: int = 256,
        **settings: Any,
    ) -> list[Image]:
        """The scene solved once and seen by each camera.

        Skips the test where another technique draws the same.
        """
        if self.name in ALIKE and scene.medium is None and not scene.volumes:
            pytest.skip(f"without air {self.name} is {ALIKE[self.name]}")
        if self.name == MITSUBA:
            return [_reference(dataclasses.replace(scene, camera=c), size, spp) for c in cameras]
        own = {k: v for k, v in {**SMALL, **settings}.items() if k in _known(self.name)}
        with Renderer(scene, self.name, size, settings=own) as renderer:
            return [renderer.frame(camera=camera) for camera in cameras]

    def air_image(
        self,
        scene: Scene,
        size: tuple[int, int] = (24, 24),
        needs: Sequence[str] = (),
        **settings: Any,
    ) -> Image:
        """The same; skips the test where air is not drawn, or wrong by design.

        `needs` are layers without which the question cannot be put.
        """
        if self.name in BASELINES:
            pytest.skip(f"{self.name} is a baseline: {BASELINES[self.name]}")
        image = self.image(scene, size, **settings)
        for layer in ("transmittance", *needs):
            if layer not in image.layers:
                pytest.skip(f"{self.name} draws no layer '{layer}'")
        return image


def _known(technique: str) -> set[str]:
    """The names of a technique's settings."""
    return {f.name for f in dataclasses.fields(technique_settings(technique))}


@pytest.fixture(params=ALIKE)
def two_alike(request: pytest.FixtureRequest, gpu: Any) -> Callable[[Scene], list[Image]]:
    """two_alike(scene) -> the images of a technique and of the one that it is without air."""
    names = (request.param, ALIKE[request.param])
    # By the settings that both have: `auto` has fewer of its own.
    known = set.intersection(*(_known(name) for name in names))
    settings = {k: v for k, v in SMALL.items() if k in known}

    def drawn(scene: Scene) -> list[Image]:
        images = []
        for name in names:
            with Renderer(scene, name, (24, 24), settings=settings) as renderer:
                images.append(renderer.frame())
        return images

    return drawn


def _reference(scene: Scene, size: tuple[int, int], spp: int) -> Image:
    """Mitsuba's image, its layers named as a technique names them."""
    from airlight.reference.mitsuba import render_layers

    has_air = scene.medium is not None or bool(scene.volumes)
    air = ("single_scatter", "multiple_scatter", "transmittance") if has_air else ()
    images = render_layers(scene, ("all", "direct", "indirect", *air), size=size, spp=spp)
    whole = images.pop("all")
    layers = {name: image.radiance for name, image in images.items()}
    noise = {f"{name}_variance": image.layers["variance"] for name, image in images.items()}
    return Image(whole.radiance, {**layers, **noise, "variance": whole.layers["variance"]})


@pytest.fixture(
    params=[
        *TECHNIQUES,
        pytest.param(MITSUBA, marks=(pytest.mark.slow, pytest.mark.needs("mitsuba"))),
    ]
)
def judged(request: pytest.FixtureRequest) -> Judged:
    """Each technique in turn."""
    if request.param != MITSUBA:
        request.getfixturevalue("gpu")
    return Judged(request.param)


def _error(image: Image, truth: np.ndarray, layer: str = "") -> float:
    """Relative L2 beyond three times the image's own noise (a technique has none)."""
    pixels = (image.layers[layer] if layer else image.radiance).astype(np.float64)
    true = np.broadcast_to(np.asarray(truth, np.float64), pixels.shape)
    norm = max(float(np.sqrt(np.sum(true**2))), 1e-12)
    variance = image.layers.get(f"{layer}_variance" if layer else "variance", np.zeros(1))
    noise = math.sqrt(float(np.sum(variance, dtype=np.float64)))
    return max(0.0, float(np.sqrt(np.sum((pixels - true) ** 2))) - 3.0 * noise) / norm


def _unlike(image: Image, truth: Image, layer: str, *, is_mirrored: bool = False) -> float:
    """Relative L2 of a layer of two images beyond what the noise of both explains.

    A technique has none. Mitsuba's is known from batches; three deviations of it are let pass in
    the pixels, and none of that in the sum over all of them, where it averages out: what the two
    differ by there, beyond four deviations of the sum, counts too.
    """
    a, b = (x.layers[layer].astype(np.float64) for x in (image, truth))
    nothing = np.zeros_like(b)
    spread = [x.layers.get(f"{layer}_variance", nothing).astype(np.float64) for x in (image, truth)]
    if is_mirrored:
        a = a[:, ::-1]
    variance = float(spread[0].sum() + spread[1].sum())
    pixels = math.sqrt(float(np.sum((a - b) ** 2))) - 3.0 * math.sqrt(variance)
    total = abs(float(a.sum() - b.sum())) - 4.0 * math.sqrt(variance)
    norm = max(float(np.sqrt(np.sum(b**2))), 1e-12)
    return max(0.0, pixels / norm, total / max(float(b.sum()), 1e-12))


@pytest.fixture(scope="session")
def unlike() -> Callable[..., float]:
    """unlike(image, truth, layer, is_mirrored=False) -> relative L2."""
    return _unlike


@pytest.fixture(scope="session")
def error() -> Callable[..., float]:
    """error(image, truth, layer="") -> relative L2."""
    return _error
