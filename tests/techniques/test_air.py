from dataclasses import replace

import numpy as np
import pytest

from airlight.lighting.lattice_box import MEDIUM_BEYOND
from airlight.rendering import Renderer, render
from airlight.scene import Environment, Medium

from .conftest import SIZE, SMALL

LAYERS = ("direct", "indirect", "single_scatter", "multiple_scatter")


def rendered(scene, technique, **settings):
    return render(scene, technique, SIZE, settings={**SMALL, **settings}, samples=1)


@pytest.mark.parametrize("technique", ["single", "lpv-march", "lpv-sum", "lpv-scatter"])
def test_layers_add_up_and_are_finite(foggy_box, technique):
    image = rendered(foggy_box, technique)
    total = sum(image.layers[name] for name in LAYERS)
    np.testing.assert_allclose(image.radiance, total, rtol=1e-5, atol=1e-6)
    assert np.isfinite(image.radiance).all()
    assert image.radiance.min() >= 0.0


def test_each_technique_brings_its_own_light(foggy_box):
    """Billeter2012, Fig. 5: what each of the compared techniques shows and what it lacks."""
    means = {
        name: {layer: float(image.layers[layer].mean()) for layer in LAYERS}
        for name in ("single", "lpv-march", "lpv-sum", "lpv-scatter")
        for image in [rendered(foggy_box, name)]
    }
    assert means["single"]["single_scatter"] > 0.0
    assert means["single"]["multiple_scatter"] == means["single"]["indirect"] == 0.0
    assert means["lpv-march"]["single_scatter"] == 0.0
    assert means["lpv-march"]["multiple_scatter"] > 0.0
    assert means["lpv-sum"]["single_scatter"] == pytest.approx(
        means["single"]["single_scatter"], rel=1e-4
    )
    assert means["lpv-scatter"]["multiple_scatter"] > 0.0
    assert means["lpv-scatter"]["indirect"] > 0.0


def test_transmittance_is_beer_lambert(foggy_box):
    image = rendered(foggy_box, "single")
    expected = np.exp(-0.2 * image.layers["depth"])
    np.testing.assert_allclose(image.layers["transmittance"][..., 0], expected, rtol=2e-3)


def test_direct_light_is_attenuated_both_ways(foggy_box):
    """Lamp to surface and surface to eye: the far wall's middle, in closed form."""
    clear = rendered(replace(foggy_box, medium=None), "direct").layers["direct"]
    fog = rendered(foggy_box, "single").layers["direct"]
    row, column = SIZE[1] // 2, SIZE[0] // 2
    to_light, to_eye = np.sqrt(2.0**2 + 1.0**2), 3.8
    ratio = fog[row, column, 0] / clear[row, column, 0]
    assert ratio == pytest.approx(np.exp(-0.2 * (to_light + to_eye)), rel=0.01)


def test_without_air_nothing_scatters(foggy_box):
    image = rendered(replace(foggy_box, medium=None), "lpv-scatter")
    assert float(np.abs(image.layers["single_scatter"]).max()) == 0.0
    assert float(np.abs(image.layers["multiple_scatter"]).max()) == 0.0
    np.testing.assert_allclose(image.layers["transmittance"], 1.0)


def test_black_air_scatters_nothing(foggy_box):
    black = replace(foggy_box, medium=Medium(sigma_t=(0.2, 0.2, 0.2), albedo=(0.0, 0.0, 0.0)))
    image = rendered(black, "lpv-scatter")
    assert float(image.layers["single_scatter"].max()) == 0.0
    assert float(image.layers["multiple_scatter"].max()) <= 1e-6


def test_the_lattice_holds_air_above_the_surfaces(foggy_box):
    """As far as MEDIUM_BEYOND says beyond them, all of it in one more; and nothing more where
    settings say it."""
    low, high = foggy_box.bounds
    side = float((high - low).max())
    tall = np.array([high[0], high[1] + 3.0 * side, high[2]])
    air = replace(foggy_box, medium=Medium(0.2, bounds=(tuple(low), tuple(tall))))
    for settings, top in (
        (SMALL, high[1] + MEDIUM_BEYOND * side),
        ({**SMALL, "bounds": (0, 0, 0, 1, 1, 1)}, 1),
    ):
        with Renderer(air, "lpv-scatter", SIZE, settings=settings) as renderer:
            lattices = renderer.technique.kit.lattices
        place = lattices.nest.over_inner
        largest = float(lattices.largest.placement.bounds[1][1])
        assert (largest >= tall[1]) == ("bounds" not in settings)
        ends = float(place.bounds[1][1])
        assert top <= ends <= top + 2.6 * place.cell


def test_the_sky_s_air_follows_blockers_that_views_see(foggy_box):
    """Where cells are bent by walls, a moved camera that sees others recomputes the warp."""
    scene = replace(foggy_box, environment=Environment((0.3, 0.4, 0.5)))
    scene = replace(scene, medium=Medium((0.2,) * 3, bounds=((-1, 0, -1), (1, 1, 1))))
    settings = {
        **SMALL,
        "sky_lights": 4,
        "sky_resolution": 8,
        "surfel_source": "views",
        "surfel_resolution": 16,
    }
    x, y, z = scene.camera.position
    with Renderer(scene, "lpv-march", SIZE, settings=settings) as renderer:
        versions = []
        for camera in (scene.camera, scene.camera, replace(scene.camera, position=(x, y, z - 0.1))):
            renderer.frame(camera=camera, read=False)
            technique = renderer.technique
            sky_air = technique.media.sky
            versions.append((technique.kit.blockers.version, sky_air.version))
    assert versions == [(1, 1), (1, 1), (2, 2)]
