import dataclasses
import itertools

import numpy as np
import pytest

from airlight.errors import SettingsError
from airlight.pop.media import PopMedia
from airlight.rendering import Renderer, render
from airlight.scene import Medium, PointLight
from airlight.scene.shapes import box
from airlight.techniques import TECHNIQUES, checked_settings, settings_class
from airlight.techniques.auto import recipe_for

from .conftest import SIZE, SMALL, small_smoke


def chosen(scene) -> str:
    with Renderer(scene, "auto", SIZE, settings=SMALL) as renderer:
        return renderer.stats()["chosen"]


def test_no_air_is_lit_by_a_propagation_volume(foggy_box):
    assert chosen(dataclasses.replace(foggy_box, medium=None)) == "lpv"


def test_fog_is_solved_on_the_lattice(foggy_box):
    assert chosen(foggy_box) == "lpv-scatter"
    ours, theirs = (
        render(foggy_box, name, SIZE, settings=SMALL, samples=1) for name in ("auto", "lpv-scatter")
    )
    np.testing.assert_array_equal(ours.radiance, theirs.radiance)


def test_a_ball_that_shades_a_room_with_a_light_is_part_of_the_lattice(smoke_over_floor):
    light = (PointLight((0.0, 4.0, 0.0), (9.0, 9.0, 9.0)),)
    under_light = dataclasses.replace(smoke_over_floor, lights=light)
    assert chosen(under_light) == "lpv with pop", "a density grid is not"
    fog = Medium(sigma_t=(0.05, 0.05, 0.05))
    assert chosen(dataclasses.replace(under_light, medium=fog)) == "lpv-scatter"
    (smoke,) = smoke_over_floor.volumes
    ball = dataclasses.replace(smoke, density=None, shape="sphere")
    assert chosen(dataclasses.replace(under_light, volumes=(ball,))) == "lpv-scatter"
    thin = dataclasses.replace(ball, sigma_t=(0.02, 0.02, 0.02))
    assert chosen(dataclasses.replace(under_light, volumes=(thin,))) == "lpv with pop"


@pytest.mark.parametrize("fog", [None, Medium(sigma_t=(0.05,) * 3)])
def test_how_much_a_volume_shades_a_room_does_not_depend_on_its_turn(smoke_over_floor, fog):
    (smoke,), (floor,) = smoke_over_floor.volumes, smoke_over_floor.meshes
    room = np.diag([6.0, 3.0, 5.0, 1.0])  # sides of 21 m^2 in the mean

    def turn(angle_rad):
        c, s = np.cos(angle_rad), np.sin(angle_rad)
        return np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]])

    found = []
    for half, of_volume, of_room in itertools.product((0.48, 0.6), (0.0, 0.785), (0.0, 0.785)):
        thick = dataclasses.replace(
            smoke,
            density=None,
            shape="box",
            sigma_t=(9.0,) * 3,
            bounds=((-half,) * 3, (half,) * 3),
            world_from_volume=turn(of_volume),
        )
        scene = dataclasses.replace(
            smoke_over_floor,
            meshes=(
                dataclasses.replace(floor, geometry=box(), world_from_object=turn(of_room) @ room),
            ),
            volumes=(thick,),
            # In the volume, so that fog's lattice has it only where it shades the room.
            lights=(PointLight((0.0, 0.0, 0.0), (1.0,) * 3),),
            medium=fog,
        )
        found.append(recipe_for(scene))
    grid = "lpv with pop" if fog is None else "lpv-scatter with pop"
    assert found == [*[grid] * 4, *["lpv-scatter"] * 4]


def test_few_volumes_that_are_alike_share_a_grid(smoke_over_floor):
    (smoke,) = smoke_over_floor.volumes

    def of(*volumes, **others) -> str:
        return recipe_for(dataclasses.replace(smoke_over_floor, volumes=volumes, **others))

    assert of(*[smoke] * 16) == "lpv with pop"
    assert of(*[smoke] * 17) == "lpv-scatter"
    assert of(*[smoke] * 5, medium=Medium((0.05,) * 3)) == "lpv-scatter"
    # As many of any kinds as have grids of their own.
    thinner = dataclasses.replace(smoke, sigma_t=tuple(0.1 * x for x in smoke.sigma_t))
    for change, chosen_for_five in (
        ({"albedo": (0.1, 0.5, 0.9)}, "lpv-scatter"),
        ({"g": (0.85,) * 3}, "lpv-scatter"),
        ({"sigma_t": (9.0, 5.0, 2.0)}, "lpv-scatter"),
        ({}, "lpv with pop"),
    ):
        other = dataclasses.replace(thinner, **change)
        assert of(*[smoke] * 3, other) == "lpv with pop"
        assert of(*[smoke] * 4, other) == chosen_for_five, change


def test_volumes_in_fog_are_part_of_its_lattice_where_cells_resolve_them(smoke_over_floor):
    foggy = dataclasses.replace(smoke_over_floor, medium=Medium(sigma_t=(0.05,) * 3))
    assert recipe_for(foggy) == "lpv-scatter"
    assert recipe_for(small_smoke(foggy)) == "lpv-scatter with pop"
    # Denser than cells can be; of what scatters straight on, less fills a cell.
    (smoke,) = foggy.volumes
    dense = dataclasses.replace(smoke, sigma_t=(90.0,) * 3, albedo=(1.0,) * 3)
    assert recipe_for(dataclasses.replace(foggy, volumes=(dense,))) == "lpv-scatter with pop"
    # Light that falls off within cells is drawn from the grid of the volume it is in.
    for height, chosen_for_it in ((2.6, "lpv-scatter with pop"), (3.5, "lpv-scatter")):
        local = PointLight((0.0, height, 0.0), (0.01,) * 3)
        thin = dataclasses.replace(smoke, sigma_t=(0.05,) * 3)
        lit = dataclasses.replace(foggy, lights=(*foggy.lights, local), volumes=(thin,))
        assert recipe_for(lit) == chosen_for_it, height
    forwards = dataclasses.replace(dense, g=(0.9,) * 3)
    assert recipe_for(dataclasses.replace(foggy, volumes=(forwards,))) == "lpv-scatter"


@pytest.mark.parametrize("turn_rad", [0.2, 0.5, 0.785])
def test_turning_a_scene_does_not_change_how_its_volumes_are_solved(smoke_over_floor, turn_rad):
    foggy = dataclasses.replace(smoke_over_floor, medium=Medium(sigma_t=(0.05,) * 3))
    turn, (c, s) = np.eye(4), (np.cos(turn_rad), np.sin(turn_rad))
    turn[:3, :3] = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
    (smoke,), (floor,), camera = foggy.volumes, foggy.meshes, foggy.camera
    turned_floor = dataclasses.replace(floor, world_from_object=turn @ floor.world_from_object)
    # Volumes a bit smaller and larger than two cells of .267 m, and a light a bit nearer and
    # farther than as much.
    found = []
    for half, beside_m in ((0.25, 2.0), (0.29, 2.0), (0.29, 0.78), (0.29, 0.88)):
        box = ((-half, 1.5 - half, -half), (half, 1.5 + half, half))
        puff = dataclasses.replace(smoke, sigma_t=(0.05,) * 3, bounds=box)
        place = np.array([beside_m, 1.5, 0.0])
        straight, turned = (
            dataclasses.replace(
                foggy,
                meshes=(mesh,),
                volumes=(dataclasses.replace(puff, world_from_volume=matrix),),
                camera=dataclasses.replace(
                    camera,
                    position=tuple(matrix[:3, :3] @ camera.position),
                    target=tuple(matrix[:3, :3] @ camera.target),
                ),
                lights=(PointLight(tuple(matrix[:3, :3] @ place), (1.0,) * 3),),
            )
            for mesh, matrix in ((floor, np.eye(4)), (turned_floor, turn))
        )
        found.append(recipe_for(straight))
        assert recipe_for(turned) == found[-1], (half, beside_m)
    grid, lattice = "lpv-scatter with pop", "lpv-scatter"
    assert found == [grid, lattice, grid, lattice]


def test_smoke_of_another_solver_keeps_from_fog_what_it_absorbs(foggy_box, smoke_over_floor):
    # Ash around the point light, of which fog outside, and what it lights, get the rest.
    (smoke,) = smoke_over_floor.volumes
    around = ((-0.13, 0.87, -0.13), (0.13, 1.13, 0.13))
    ash = dataclasses.replace(smoke, sigma_t=(11.0,) * 3, albedo=(0.0,) * 3, bounds=around)
    scene = dataclasses.replace(foggy_box, volumes=(ash,))
    assert recipe_for(scene) == "lpv-scatter with pop"
    # What scatters nothing has no light of its own: the lattice that holds both is the truth.
    settings = {**SMALL, "gather": "off"}
    both, one, clear = (
        render(of, name, SIZE, settings=settings, samples=1).layers
        for of, name in ((scene, "auto"), (scene, "lpv-scatter"), (foggy_box, "lpv-scatter"))
    )
    for name in ("indirect", "multiple_scatter"):
        assert one[name].mean() < 0.5 * clear[name].mean()
        assert both[name].mean() == pytest.approx(one[name].mean(), rel=0.005), name


def test_all_three_solvers_in_one_frame(smoke_over_floor):
    fog = Medium(sigma_t=(0.05, 0.05, 0.05))
    scene = dataclasses.replace(small_smoke(smoke_over_floor), medium=fog)
    assert recipe_for(scene) == "lpv-scatter with pop"
    image = render(scene, "auto", SIZE, settings=SMALL, samples=1)
    for name in ("direct", "indirect", "single_scatter", "multiple_scatter"):
        assert image.layers[name].mean() > 0.0, name


def test_auto_takes_the_settings_of_what_it_chooses(foggy_box, smoke_over_floor):
    clear = dataclasses.replace(foggy_box, medium=None)
    with Renderer(clear, "auto", SIZE, settings={**SMALL, "cascades": "2"}) as renderer:
        assert len(renderer.stats()["cascades"]) == 2
    assert settings_class("auto", foggy_box).__dataclass_fields__.keys() >= {"acceleration"}
    # Where volumes have a solver of their own, its settings count too.
    several = {**SMALL, "ordinates": 9, "iterations": 3, "march_resolution": "full"}
    with Renderer(smoke_over_floor, "auto", SIZE, settings=several) as renderer:
        assert renderer.stats()["iterations"] == 3
        assert renderer.technique.find(PopMedia).solvers[0].settings.ordinates == 9
        assert renderer.technique.find(PopMedia).solvers[0].settings.iterations == 20


def test_a_setting_that_auto_has_not_here_is_told_with_who_has_it(foggy_box):
    with pytest.raises(SettingsError) as caught:
        checked_settings("auto", foggy_box, {"storage": "float16"})
    having = [name for name, known in TECHNIQUES.items() if "storage" in vars(known())]
    assert {"lpv", "lpv-march", "lpv-sum"} <= set(having)
    assert str(caught.value) == (
        "technique auto, here lpv-scatter: there is no setting 'storage'. "
        f"{', '.join(having)} have it"
    )
    with pytest.raises(SettingsError, match="Did you mean 'resolution'"):
        checked_settings("auto", foggy_box, {"resolutoin": 9})
    in_file = dataclasses.replace(foggy_box, settings={"auto": {"samples": 3}})
    assert checked_settings("auto", in_file, {}).samples == 3
    bare = dataclasses.replace(in_file, medium=None)
    with pytest.raises(SettingsError, match="here lpv: there is no setting 'samples'"):
        checked_settings("auto", bare, {})
