import dataclasses

from airlight.rendering import Renderer, render
from airlight.scene import Medium, PointLight
from airlight.techniques import composed

from .conftest import SIZE, SMALL


def chosen(scene) -> str:
    assert composed.Auto.Settings is composed.AutoSettings
    with Renderer(scene, "auto", SIZE, settings=SMALL) as renderer:
        return renderer.stats()["chosen"]


def test_no_air_is_lit_by_a_propagation_volume(foggy_box):
    assert chosen(dataclasses.replace(foggy_box, medium=None)) == "Lpv"


def test_fog_is_solved_on_the_lattice(foggy_box):
    assert chosen(foggy_box) == "LpvScatter"


def test_smoke_that_shades_a_room_with_a_lamp_is_part_of_the_lattice(smoke_over_floor):
    lamp = (PointLight((0.0, 4.0, 0.0), (9.0, 9.0, 9.0)),)
    under_lamp = dataclasses.replace(smoke_over_floor, lights=lamp)
    assert chosen(under_lamp) == "LpvScatter"
    (smoke,) = smoke_over_floor.volumes
    thin = dataclasses.replace(smoke, sigma_t=(0.02, 0.02, 0.02))
    assert chosen(dataclasses.replace(under_lamp, volumes=(thin,))) == "WithPop"


def test_all_three_solvers_in_one_frame(smoke_over_floor):
    fog = Medium(sigma_t=(0.05, 0.05, 0.05))
    image = render(
        dataclasses.replace(smoke_over_floor, medium=fog), "auto", SIZE, settings=SMALL, samples=1
    )
    for name in ("direct", "indirect", "single_scatter", "multiple_scatter"):
        assert image.layers[name].mean() > 0.0, name
