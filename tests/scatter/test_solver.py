"""A lamp in foggy rooms: what walls keep, what schemes agree on, what is refused."""

import dataclasses

import numpy as np
import pytest

from airlight.errors import SettingsError
from airlight.rendering import Renderer
from airlight.scatter.settings import ScatterSettings, densest_medium, is_varied
from airlight.scatter.solver import ScatterSolver
from airlight.scene.environment import Environment
from airlight.scene.material import Material
from airlight.scene.medium import Medium
from airlight.scene.volume import Volume

from .rooms import FOG, HIGH, LOW, Solved, light_scene, room, sheet  # type: ignore[import-not-found]

BOX = (tuple(LOW - 0.5), tuple(HIGH + 0.5))


@pytest.mark.parametrize("acceleration", ["none", "regions"])
def test_no_light_goes_through_a_closed_wall(gpu, acceleration):
    lit = Solved(gpu, light_scene(*room(sheet(0, 0.0))), acceleration=acceleration).mean_radiance
    bright, dark = lit[1:-1, 1:-1, 1:8].mean(), lit[1:-1, 1:-1, 11:-1].mean()
    assert bright > 0.1
    assert dark < 0.003 * bright


def test_walls_that_reflect_keep_the_fog_bright(gpu):
    """NOTES 2a: without the bounce a room holds a quarter to two thirds of its light."""
    black = Material(base_color=(0.0, 0.0, 0.0))
    white, dark = (
        Solved(gpu, light_scene(*room(material=m)), iterations=24).mean_radiance.mean()
        for m in (Material(base_color=(0.7, 0.7, 0.7)), black)
    )
    assert 1.5 < white / dark < 8.0


def test_half_linear_is_deposit_in_a_homogeneous_medium(gpu):
    scene = light_scene(*room())
    even, varied = (
        Solved(gpu, scene, scheme=s, acceleration="none").mean_radiance
        for s in ("deposit", "half-linear")
    )
    # Cells beyond the walls lie outside the medium, which fills the walls' bounds.
    np.testing.assert_allclose(
        varied[2:-2, 2:-2, 2:-2], even[2:-2, 2:-2, 2:-2], rtol=0.01, atol=1e-4
    )


def test_a_volume_of_the_same_air_is_the_medium(gpu):
    volume = Volume(FOG.sigma_t, shape="box", bounds=BOX, albedo=FOG.albedo)
    medium = dataclasses.replace(FOG, bounds=BOX)
    one = Solved(gpu, light_scene(*room(), medium=medium)).mean_radiance
    other = Solved(gpu, light_scene(*room(), medium=None, volumes=(volume,))).mean_radiance
    np.testing.assert_allclose(other, one, rtol=0.02, atol=1e-3 * one.max())


def test_clear_air_scatters_nothing_but_carries_indirect_light(gpu):
    clear = Medium((0.0, 0.0, 0.0))
    got = Solved(gpu, light_scene(*room(), medium=clear))
    assert np.isfinite(got.mean_radiance).all()
    # The lamp's light, reflected once, is all that comes in.
    assert got.source[..., 0].sum() == pytest.approx(3 * 0.7 * 4 * np.pi, rel=0.05)
    assert Solved(gpu, light_scene(*room(), medium=None)).mean_radiance.mean() > 0.0


def test_an_environment_lights_the_fog_of_an_open_room(gpu):
    scene = light_scene(*room()[:3], environment=Environment(radiance=(1.0, 1.0, 1.0)))
    scene = dataclasses.replace(scene, lights=())
    got = Solved(gpu, scene)
    assert got.source[..., 0].sum() > 0.0
    assert 0.0 < got.mean_radiance.max() < 1.1


def test_emissive_walls_light_the_fog(gpu):
    glowing = Material(base_color=(0.0, 0.0, 0.0), emission=(1.0, 0.5, 0.0))
    walls = (*room()[1:], sheet(0, -2.0, material=glowing))
    scene = light_scene(*walls, lights=())
    got = Solved(gpu, scene)
    power = got.source[..., 0].sum(axis=(1, 2, 3))
    # A sheet of 4 m^2 gives pi L to the room's side. Its light is scattered or reflected for the
    # first time; the rest is absorbed by fog (.95) and grey walls (.7), or leaves where none is.
    assert 0.5 * 4.0 * np.pi < power[0] < 0.95 * 4.0 * np.pi
    assert power[1] == pytest.approx(0.5 * power[0], rel=1e-3)
    assert power[2] == 0.0


def test_forward_scattering_is_solved_as_its_reduced_isotropic_medium(gpu):
    forward = Medium((5.0, 5.0, 5.0), (0.99, 0.99, 0.99), (0.9, 0.9, 0.9))
    s, t = 5.0 * 0.99 * 0.1, 5.0 * (0.99 * 0.1 + 0.01)
    similar = Medium((t,) * 3, (s / t,) * 3)
    one, other = (
        Solved(gpu, light_scene(*room(), medium=m)).mean_radiance for m in (forward, similar)
    )
    np.testing.assert_allclose(one, other, rtol=1e-3)


def test_the_paper_scheme_is_near_in_thin_air_and_refused_in_dense(gpu):
    thin = light_scene(*room(), medium=Medium((0.2, 0.2, 0.2), (0.9, 0.9, 0.9)))
    ours, paper = (
        Solved(gpu, thin, scheme=s, acceleration="none", iterations=8).mean_radiance.mean()
        for s in ("deposit", "paper-gamma")
    )
    assert 0.3 < paper / ours < 2.0
    dense = light_scene(*room(), medium=Medium((4.0, 4.0, 4.0)))
    with pytest.raises(SettingsError, match="scheme = 'paper' needs less than 1 mean free path"):
        Solved(gpu, dense, scheme="paper")


def test_a_scheme_for_a_homogeneous_medium_refuses_volumes_and_bounded_media():
    settings = ScatterSettings(scheme="deposit")
    scene = light_scene(volumes=(Volume(FOG.sigma_t, shape="sphere"),))
    from airlight.lattice.placement import fitted

    placement = fitted(LOW, HIGH, 16)
    with pytest.raises(SettingsError, match="'deposit' knows only one medium that fills the latt"):
        is_varied(scene, placement, settings)
    small = dataclasses.replace(FOG, bounds=((0, 0, 0), (1, 1, 1)))
    with pytest.raises(SettingsError, match="leave out volumes and the medium's bounds"):
        is_varied(light_scene(medium=small), placement, settings)
    assert is_varied(light_scene(medium=small), placement, ScatterSettings())
    assert not is_varied(light_scene(), placement, ScatterSettings())


def test_the_densest_air_decides():
    grid = np.full((2, 2, 2), 3.0, np.float32)
    volume = Volume((1.0, 2.0, 3.0), grid, albedo=(0.5, 1.0, 1.0))
    sigma_s, sigma_t = densest_medium(light_scene(volumes=(volume,)))
    assert sigma_t == (3.0, 6.0, 9.0)
    assert sigma_s == (1.5, 6.0, 9.0)
    assert densest_medium(light_scene(medium=None)) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_iterations_to_a_residual_are_counted_before_the_frame(gpu):
    solved = Solved(gpu, light_scene(*room()), residual=0.1, acceleration="none")
    stats = solved.solver.stats
    assert stats["levels"] == 1
    assert 10 < stats["iterations"] < 200


def test_stills_are_solved_further_and_leave_frames_as_they_are(gpu):
    settings = {"resolution": 12, "shadow_resolution": 64, "lamp_resolution": 64, "surfels": 5000}
    with Renderer(light_scene(*room()), "lpv-scatter", (16, 9), settings=settings) as renderer:

        def drawn(samples):
            image = renderer.frame(samples=samples)
            light = renderer.technique.find(ScatterSolver).emission.mean.read()
            return image.radiance, light, renderer.stats()["iterations"]

        frame, few, steps = drawn(1)
        _, more, still_steps = drawn(2)
        again = drawn(1)
    assert (steps, still_steps) == (24, 48)
    assert (more != few).any()
    np.testing.assert_array_equal(again[0], frame)
    np.testing.assert_array_equal(again[1], few)
