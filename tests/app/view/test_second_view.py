"""Another view of what a renderer has solved: the same image as one that solves for itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from airlight.app.view.second_view import SecondView, can_show
from airlight.errors import DeviceError
from airlight.rendering import Renderer
from airlight.scene import Environment, Material, Medium, Mesh
from airlight.scene.io import load
from airlight.scene.shapes import box
from airlight.techniques.beside import Beside
from small_viewer import SETTINGS

SIZE, OTHER = (24, 14), (40, 24)
SMALL = {**SETTINGS, "sky_lights": 8, "map_resolution": 32}
GATHERED = {"gather": "always", "gather_rays": 4}


def room():
    """A spot, a surface that shines, a sky, matt and smooth surfaces."""
    scene = load("builtin:cornell")
    shining = Mesh(box(), Material(emission=(5.0, 5.0, 5.0)), placed(0.0))
    smooth = Mesh(box(), Material(roughness=0.05, metallic=1.0), placed(1.5))
    sky = Environment(radiance=(0.5, 0.6, 0.7))
    return replace(scene, meshes=(*scene.meshes, shining, smooth), environment=sky)


def placed(x: float) -> np.ndarray:
    at = np.eye(4)
    at[:3, 3] = x, 3.0, 0.0
    return at


@pytest.fixture
def first(gpu):
    with Renderer(room(), "lpv", SIZE, settings=SMALL) as made:
        made.frame(read=False)
        yield made


def expected(scene, samples: int) -> np.ndarray:
    with Renderer(scene, "lpv", OTHER, settings={**SMALL, **GATHERED}) as alone:
        return alone.frame(samples=samples).radiance


@pytest.mark.parametrize("samples", [1, 2])
def test_it_is_the_image_of_a_renderer_of_its_own(first, samples):
    with SecondView(first, OTHER, GATHERED) as second:
        assert isinstance(second.technique, Beside)
        assert second.technique.kit.lattices is first.technique.kit.lattices
        found = second.frame(samples=samples)
    assert np.array_equal(found.radiance, expected(first.scene, samples))
    assert found.stats["size"] == list(OTHER)
    assert found.stats["iterations"] == first.stats()["iterations"]


def test_it_solves_nothing(first, monkeypatch):
    with SecondView(first, OTHER, GATHERED) as second:
        for part in (first.technique.kit, *first.technique.solvers):
            monkeypatch.setattr(part, "encode" if part is first.technique.kit else "solve", None)
        second.frame(samples=2)


def test_it_sees_what_the_first_one_solves_later(first):
    scene = first.scene
    lights = tuple(replace(light, intensity=(9.0, 1.0, 1.0)) for light in scene.lights)
    with SecondView(first, OTHER, GATHERED) as second:
        before = second.frame(samples=2).radiance
        first.frame(lights=lights, read=False)
        found = second.frame(lights=lights, samples=2).radiance
    assert not np.array_equal(found, before)
    assert np.array_equal(found, expected(replace(scene, lights=lights), 2))


def test_the_first_one_may_be_closed_before_it(gpu):
    before = gpu.allocated_bytes
    first = Renderer(room(), "lpv", SIZE, settings=SMALL)
    first.frame(read=False)
    second = SecondView(first, OTHER, GATHERED)
    found = second.frame(samples=2).radiance
    first.close()
    assert np.array_equal(second.frame(samples=2).radiance, found)
    second.close()
    assert gpu.allocated_bytes == before
    with pytest.raises(DeviceError, match="closed"):
        SecondView(first, OTHER, GATHERED)


def test_solutions_that_stills_have_of_their_own_are_not_lent(gpu, first):
    assert can_show(first, {"gather": "always"})
    assert can_show(first, {})
    assert not can_show(first, {"resolution": 16})
    foggy = replace(room(), medium=Medium((0.1,) * 3))
    with Renderer(foggy, "lpv-scatter", SIZE, settings=SETTINGS) as other:
        assert not can_show(other, {"gather": "always"})
