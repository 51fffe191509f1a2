"""More than four media share one grid: means of what they are, and the light in all of them."""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import replace

import numpy as np
import pytest

from airlight.gpu.device import Gpu
from airlight.pop.medium.kinds import grid_plan, sorted_by_kind
from airlight.pop.medium.merging import merged_volume, merged_width
from airlight.pop.medium.placement import medium_width, placed
from airlight.pop.settings import PopSettings
from airlight.rendering import Renderer, render
from airlight.scene import Camera, DirectionalLight, Environment, Medium, Scene, Volume

from .test_media import SETTINGS, images

SIZE = (32, 24)
WHITE = Environment((1.0, 1.0, 1.0))
CAMERA = Camera((1.2, 1.6, 4.5), (0.0, 0.0, 0.0), fov_y_deg=40.0)
SUN = DirectionalLight((-0.5, -0.7, -0.4), (3.0, 3.0, 3.0))


def ball(centre: tuple[float, float, float], radius: float = 0.3, per_m: float = 4.0) -> Volume:
    low, high = (tuple(np.add(centre, r)) for r in (-radius, radius))
    return Volume((per_m, per_m, 2.0 * per_m), shape="sphere", bounds=(low, high))


def test_coefficients_are_means_over_what_there_is() -> None:
    """A ball of 2 per m, eight times as large as a grid's box of density 1/2 that absorbs."""
    one = Volume((2.0,) * 3, shape="box", bounds=((0, 0, 0), (2, 2, 2)), g=(0.5, 0.0, -0.5))
    density = np.full((3, 3, 3), 0.5, np.float32)
    two = Volume((6.0,) * 3, density, bounds=((4, 0, 0), (5, 1, 1)), albedo=(0.0, 0.5, 1.0))
    whole = merged_volume([one, two])
    assert whole.bounds == ((0, 0, 0), (5, 2, 2))
    assert whole.sigma_t == pytest.approx([(8 * 2 + 0.5 * 6) / 8.5] * 3)
    assert whole.albedo == pytest.approx([16 / 19, (16 + 1.5) / 19, 1.0])
    assert whole.g == pytest.approx([0.5, 0.0, -0.5 * 16 / 19])


def test_a_puff_is_as_wide_among_others_as_alone() -> None:
    apart = [ball((2.0 * i, 0.0, 0.0)) for i in range(6)]
    alone = medium_width(apart[0], placed(apart[0], 8))
    width = merged_width(apart, merged_volume(apart))
    assert width.diffusivity == pytest.approx(alone.diffusivity)
    assert width.density == pytest.approx(alone.density)
    # What meets is one body: a row of balls that overlap is left sideways, not along.
    row = [ball((0.3 * i, 0.0, 0.0)) for i in range(6)]
    wider = merged_width(row, merged_volume(row)).diffusivity
    assert 1.05 * alone.diffusivity < wider < 1.5 * alone.diffusivity
    # All in one place: as wide as one.
    same = [ball((0.0, 0.0, 0.0))] * 6
    assert merged_width(same, merged_volume(same)).diffusivity == pytest.approx(alone.diffusivity)


def test_nothing_is_as_wide_as_its_box() -> None:
    empty = [Volume((0.0,) * 3, np.zeros((2, 2, 2), np.float32))] * 5
    width = merged_width(empty, merged_volume(empty))
    assert np.isfinite([width.diffusivity, width.density, width.mass]).all()


@pytest.mark.slow
def test_a_white_furnace_hides_many(gpu: Gpu) -> None:
    """Balls apart and overlapping, of several g and colours, and fog around them."""
    centres = itertools.product((-0.6, 0.1, 0.5), (-0.4, 0.4), (-0.3, 0.3))
    balls = tuple(
        dataclasses.replace(ball(centre, per_m=6.0), g=(0.2 * (i % 3),) * 3)
        for i, centre in enumerate(centres)
    )
    fog = Medium((0.2,) * 3, bounds=((-1.0,) * 3, (1.0,) * 3))
    scene = Scene(medium=fog, volumes=balls, environment=WHITE, camera=CAMERA)
    scattered, through = images(gpu, scene)
    assert through.min() < 0.1
    np.testing.assert_allclose(scattered + through, 1.0, atol=0.06)


def boxes(parts: int) -> tuple[Volume, ...]:
    """A box of 1.2 x .8 x 1 m, cut into so many along each of x and z."""
    at = np.linspace(-0.5, 0.5, parts + 1)
    return tuple(
        Volume(
            (5.0, 3.0, 2.0),
            shape="box",
            bounds=((1.2 * x0, -0.4, z0), (1.2 * x1, 0.4, z1)),
            albedo=(0.9, 0.95, 1.0),
            g=(0.3,) * 3,
        )
        for (x0, x1), (z0, z1) in itertools.product(itertools.pairwise(at), repeat=2)
    )


@pytest.mark.parametrize(("scheme", "most"), [("delta-beam", 0.001), ("split", 0.015)])
def test_a_box_cut_in_nine_is_the_box(gpu: Gpu, scheme: str, most: float) -> None:
    """On as many cells: 12^3, and nine eighths of it, rounded down; .00005, .010 for hops."""
    scene = Scene(lights=(SUN,), environment=WHITE, camera=CAMERA)
    settings = dataclasses.replace(SETTINGS, scheme=scheme)
    pair = [
        images(
            gpu,
            dataclasses.replace(scene, volumes=boxes(parts)),
            dataclasses.replace(settings, grid=grid),
        )[0]
        for parts, grid in ((1, 12), (3, 12))
    ]
    assert np.linalg.norm(pair[1] - pair[0]) < most * np.linalg.norm(pair[0])


def test_what_is_alike_is_of_a_kind() -> None:
    """Colours, albedos and phase functions tell kinds apart, extinctions do not; four at most."""
    settings = PopSettings()
    box = Volume((4.0,) * 3, shape="box", bounds=((0, 0, 0), (1, 1, 1)), g=(0.3,) * 3)
    dark, thin = replace(box, albedo=(0.4,) * 3), replace(box, sigma_t=(0.1,) * 3)
    red, sharp = replace(box, sigma_t=(4.0, 1.0, 1.0)), replace(box, g=(0.8,) * 3)
    nearly = replace(box, albedo=(0.95,) * 3)
    assert sorted_by_kind([box] * 6, settings) == [(0, 1, 2, 3, 4, 5)]
    assert sorted_by_kind([box, dark, thin, dark, nearly], settings) == [(0, 2, 4), (1, 3)]
    several = [box, dark, red, sharp, replace(dark, albedo=(0.2,) * 3)]
    assert sorted_by_kind(several, settings) == [(0,), (1, 4), (2,), (3,)]
    plan = grid_plan([box] * 6, settings)
    assert plan.sources == 1 and plan.kinds == [(0, 1, 2, 3, 4, 5)] and len(plan.volumes) == 6
    assert grid_plan(several, settings).sources == 4
    assert grid_plan(several[:3], settings).kinds == []
    # A grid that is empty at first counts as it will: nothing joins it for being light.
    empty = replace(box, shape="grid", density=np.zeros((2, 2, 2), np.float32), albedo=(0.0,) * 3)
    assert sorted_by_kind([*several, empty], settings) == [(0,), (1, 4, 5), (2,), (3,)]
    far = replace(empty, albedo=(0.95, 0.0, 0.0), g=(-0.8,) * 3)
    assert (5,) in sorted_by_kind([*several, far], settings)
    # Of what hops all are one.
    assert len(sorted_by_kind(several, replace(settings, scheme="split"))) == 1


def test_unlike_kinds_are_solved_as_if_they_were_two(gpu: Gpu) -> None:
    """A white box cut in four overlaps a dark one: .00002 off (all on one grid: .30)."""
    scene = Scene(lights=(SUN,), environment=WHITE, camera=CAMERA)
    dark = Volume(
        (6.0,) * 3, shape="box", bounds=((0.2, -0.5, -0.3), (0.9, 0.3, 0.4)), albedo=(0.2,) * 3
    )
    pair = [
        images(gpu, replace(scene, volumes=(*boxes(parts), dark)), replace(SETTINGS, grid=grid))[0]
        for parts, grid in ((1, 12), (2, 16))
    ]
    assert np.linalg.norm(pair[1] - pair[0]) < 0.001 * np.linalg.norm(pair[0])


def test_they_may_move(gpu: object) -> None:
    """One of them out of the box of all: the frame is a new renderer's, but for where cells lie."""
    scene = Scene(volumes=boxes(3), lights=(SUN,), environment=WHITE, camera=CAMERA)
    lifted = np.eye(4)
    lifted[:3, 3] = (0.1, 0.5, 0.0)
    moved = dataclasses.replace(scene.volumes[0], world_from_volume=lifted)
    volumes = (moved, *scene.volumes[1:])
    settings = {"grid": 6, "ordinates": 32, "march": "full"}
    with Renderer(scene, "pop", SIZE, settings=settings) as renderer:
        still = renderer.frame()
        after = renderer.frame(volumes=volumes)
        again = renderer.frame(volumes=scene.volumes)
    assert still is not None and after is not None and again is not None
    np.testing.assert_array_equal(still.radiance, again.radiance)
    fresh = render(
        dataclasses.replace(scene, volumes=volumes), "pop", SIZE, settings=settings, samples=1
    )
    norm = np.linalg.norm(fresh.layers["scattered"])
    off = np.linalg.norm(after.layers["scattered"] - fresh.layers["scattered"])
    assert off < 0.03 * norm
    assert np.linalg.norm(after.layers["scattered"] - still.layers["scattered"]) > 0.1 * norm
