"""Every technique draws the same with WebGPU's default limits and without optional features."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from airlight import Renderer, Scene
from airlight.lighting import lighting
from airlight.scene import Environment, Medium

SIZE = (16, 16)
AT_MOST = 2e-3
"""Relative L2: half floats instead of whole ones where light is filtered round by 5e-4."""


@pytest.fixture
def everything(smoke_over_floor: Scene, foggy_box: Scene) -> Scene:
    """Sun, lamp and sky; fog, and two puffs of smoke that overlap; a floor and a box."""
    smoke = smoke_over_floor.volumes[0]
    beside = dataclasses.replace(smoke, bounds=((-0.5, 0.5, -1.5), (1.5, 2.0, 0.5)))
    return dataclasses.replace(
        smoke_over_floor,
        volumes=(smoke, beside),
        lights=smoke_over_floor.lights + foggy_box.lights,
        environment=Environment((0.4, 0.4, 0.4)),
        medium=Medium(sigma_t=(0.05, 0.05, 0.05), albedo=(0.9, 0.9, 0.9)),
    )


SMALL = {
    "resolution": 8,
    "surfels": 2000,
    "shadow_resolution": 64,
    "lamp_resolution": 32,
    "sky_lights": 4,
    "sky_resolution": 16,
}
LPV = {**SMALL, "map_resolution": 32, "iterations": 8}
POP = {"ordinates": 4, "grid": 6, "solver_steps": 8, "surfels": 2000}
ALL = [
    ("direct", SMALL),
    ("single", SMALL),
    ("lpv", LPV),
    ("lpv", {**LPV, "cascades": 2}),
    ("lpv-sum", LPV),
    ("lpv-scatter", LPV),
    pytest.param("lpv-scatter", {**LPV, "cascades": 2}, marks=pytest.mark.slow),
    pytest.param("pop", POP, marks=pytest.mark.slow),
    pytest.param("pop", {**POP, "scheme": "split"}, marks=pytest.mark.slow),
    ("pop", {**POP, "scheme": "paper"}),
    ("auto", SMALL),
]


def drawn(monkeypatch, scene, technique, settings, asked):
    monkeypatch.setenv("AIRLIGHT_LIMITS", asked)
    monkeypatch.setenv("AIRLIGHT_PATHS", "gpu")
    with Renderer(scene, technique, SIZE, settings=settings) as r:
        assert r.gpu.asked == asked
        return r.frame().radiance


@pytest.mark.parametrize(("technique", "settings"), ALL)
def test_the_image_is_the_same(monkeypatch, everything, technique, settings):
    scene = everything
    if technique == "lpv":
        scene = dataclasses.replace(scene, medium=None, volumes=())
    plain, usual = (
        drawn(monkeypatch, scene, technique, settings, asked) for asked in ("default", "auto")
    )
    assert np.isfinite(plain).all() and plain.max() > 0.0
    assert np.linalg.norm(plain - usual) <= AT_MOST * np.linalg.norm(usual)


@pytest.mark.parametrize("technique", ["single", "lpv-scatter", "pop"])
def test_many_volumes_are_the_same(monkeypatch, everything, technique):
    """More than a tree takes one by one: passes bind lists of them besides."""
    volumes = tuple(
        dataclasses.replace(v, sigma_t=tuple(x / 5 for x in v.sigma_t))
        for v in everything.volumes
        for _ in range(5)
    )
    scene, given = (
        dataclasses.replace(everything, volumes=volumes),
        {"pop": POP, "single": SMALL}.get(technique, LPV),
    )
    plain, usual = (
        drawn(monkeypatch, scene, technique, given, asked) for asked in ("default", "auto")
    )
    assert plain.max() > 0.0
    assert np.linalg.norm(plain - usual) <= AT_MOST * np.linalg.norm(usual)


@pytest.mark.parametrize("technique", ["direct", "single"])
def test_lights_and_the_rest_are_the_whole(monkeypatch, foggy_box, technique):
    scene = dataclasses.replace(foggy_box, environment=Environment((0.4, 0.4, 0.4)))
    whole = drawn(monkeypatch, scene, technique, SMALL, "auto")
    monkeypatch.setattr(lighting, "fits", lambda gpu, slots: False)
    parts = drawn(monkeypatch, scene, technique, SMALL, "auto")
    np.testing.assert_allclose(parts, whole, rtol=1e-5, atol=1e-6)
