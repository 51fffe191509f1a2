"""Elek2014's figures from pretended images, and the two that need none."""

from __future__ import annotations

import json

import numpy as np
import pytest

from airlight.figures import (
    pop_1,
    pop_6,
    pop_7,
    pop_8,
    pop_10,
    pop_11,
    pop_12,
    pop_13,
    pop_14,
    pop_15,
    pop_16,
    pop_17,
    pop_ball,
    pop_cube,
    registry,
)
from airlight.figures.panels import Request, away
from airlight.figures.polar import OURS, TRUTH, polar_plots
from airlight.figures.pop_court import BRIGHTEST, courtyard
from airlight.figures.pop_scenes import (
    errors,
    milk,
    plume,
    scattered_errors,
    slab,
    turned,
)
from airlight.figures.registry import FIGURES
from airlight.reference import shdom
from airlight.scene.image import Image

QUICK = ("pop-1", "pop-6", "pop-7", "pop-8", "pop-11", "pop-14", "pop-15", "pop-16", "pop-17")


class Renderer:
    """An image that is brighter with every frame."""

    def __init__(self, scene, technique, size, *, settings, adapter):
        assert technique in ("pop", "auto")
        self.scene, self.size, self.settings = scene, size, settings
        self.frame_ms = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def frame(self, *, samples=1, read=True):
        self.frame_ms.append(10.0 + len(self.frame_ms))
        if not read:
            return None
        light = np.full((self.size[1], self.size[0], 3), 0.1 * len(self.frame_ms), np.float32)
        layers = {"scattered": 0.5 * light, "transmittance": light}
        return Image(light, layers, stats={"frame_ms": 10.0, "device": "a test", "hops": 3})

    def timed_passes(self):
        hops = self.settings.get("iterations", 1)
        return {"pop propagation": 2.0 * hops, "pop merge": 1.0, "march": 9.0}


@pytest.fixture
def pretended(monkeypatch):
    import airlight.rendering

    monkeypatch.setattr(airlight.rendering, "Renderer", Renderer)
    dark = np.zeros((25, 1, 1, 1, 3))
    monkeypatch.setattr(
        shdom, "solve", lambda medium, outside, bands: shdom.Shdom(medium, bands, dark, 0.0)
    )


@pytest.mark.parametrize("name", QUICK)
def test_a_figure_is_an_image_and_its_numbers(pretended, tmp_path, monkeypatch, name):
    monkeypatch.setattr(pop_11, "by_shdom", lambda *_, **__: np.zeros((27, 48, 3), np.float32))
    drawn = FIGURES[name].draw(Request((48, 27), quick=True))
    assert drawn.image.dtype == np.uint8
    registry.keep(name, drawn, {"command": "c"}, tmp_path)
    told = json.loads((tmp_path / f"{name}.json").read_text("utf-8"))
    assert told["beside"].startswith("Elek2014 Fig. ")
    assert told["numbers"]


def test_the_light_s_figure_compares_intensities(pretended):
    drawn = FIGURES["pop-10"].draw(Request((48, 27), quick=True))
    truth = pop_10.by_monte_carlo(pop_10.ball(0.0), 27, 0.0, 2_000)
    # Pretended: radiance .05 over a square of 2.1 R a side.
    want = 0.05 * (2.1 * pop_10.RADIUS_M) ** 2 / pop_10.seen(pop_10.ball(0.0), truth.radiance)
    told = drawn.numbers["g 0.0"]["split"]
    np.testing.assert_allclose(told["intensity_over_monte_carlo"], want, rtol=1e-5)


def test_the_residuum_s_speed_up_is_of_what_solves(pretended):
    told = FIGURES["pop-8"].draw(Request((48, 27), quick=True)).numbers["map 1, front"]
    assert set(told) == {"all hops", "residuum", "split", "delta-beam", "speed_up"}
    assert told["residuum"]["ms"] == {"pop propagation": 8.0, "pop merge": 1.0}


def test_directions_lie_in_their_bins():
    d = pop_cube.directions()
    np.testing.assert_allclose(np.linalg.norm(d, axis=-1), 1.0)
    assert np.abs(d[..., 1]).max() <= 1.0 / pop_cube.MU_BINS
    azimuth = np.arctan2(d[..., 2], d[..., 0])[:, 9]
    np.testing.assert_allclose(azimuth, np.pi / 2, atol=np.pi / pop_cube.PHI_BINS)


@pytest.mark.needs("numba")
def test_beams_and_hops_show_what_monte_carlo_shows():
    true = pop_cube.truth(0.7, 100_000)
    beams, hops = pop_cube.by_beams(0.7), pop_cube.by_hops(0.7, 8)
    for mine, off in ((beams, 0.1), (hops, 0.22)):  # eight hops: measured .81
        assert mine.radiance.shape == (16, 16, 36)
        ratio = mine.radiance.mean() / true.radiance.mean()
        assert ratio == pytest.approx(1.0, abs=off)
    smooth = [a.radiance.mean(axis=(0, 1)) for a in (true, beams)]
    np.testing.assert_allclose(smooth[1], smooth[0], atol=0.12 * smooth[0].max())


def test_a_cube_lit_along_its_middle_is_its_own_mirror_image():
    light = pop_cube.by_beams(0.7).radiance
    np.testing.assert_allclose(pop_cube.mirrored(light), light, rtol=1e-6)
    assert np.abs(light[:, ::-1] / light - 1.0).max() > 0.1  # directions must turn, too


def test_curves_are_drawn_in_their_colours():
    round_, peak = np.ones((2, 2, 36)), np.zeros((2, 2, 36))
    peak[..., 9] = 1.0
    plot = polar_plots([(TRUTH, round_), (OURS, peak)], 120)
    assert plot.shape == (120, 120, 3)
    red = plot[..., 0].astype(int) - plot[..., 2]
    assert red.max() > 60
    assert red.min() < -60


def test_scenes_and_scores():
    for scene in (plume(), slab(0.9), milk()):
        assert len(scene.volumes) == 1
    assert turned(plume(), 30.0).environment.rotation_deg == 30.0
    sky = courtyard(64).map
    assert sky.max() == pytest.approx(BRIGHTEST, rel=0.3)
    assert sky.min() > 0.01
    assert sky[32].max() < sky[20].max() / 5.0  # dark walls below a bright sky
    one = np.ones((4, 4, 3), np.float32)
    truth = Image(one, {"variance": 0.01 * one})
    told = errors(1.5 * one, truth)
    assert told["energy_ratio"] == pytest.approx(1.5)
    assert told["relative_l2"] == pytest.approx(0.5)
    assert told["noise_floor_l2"] == pytest.approx(0.1)
    assert away(one, one) == 0.0


def test_light_that_changes_evenly_is_steady():
    even = [np.full((3, 3), 1.0 + 0.1 * k) for k in range(5)]
    told = pop_16.steadiness(even)
    assert told["jerk"] == pytest.approx(0.0, abs=1e-12)
    assert told["change"] == pytest.approx(0.1 / 1.2)


def test_the_host_s_marching_sees_an_even_emission_as_one_minus_transmittance():
    scene = plume()
    medium = pop_11.medium_of(scene, (6, 8, 6))
    light = pop_11.marched(scene, medium, np.ones((6, 8, 6, 3)), (16, 9))
    assert light.shape == (9, 16, 3)
    # No more than the albedo.
    assert (light.max(axis=(0, 1)) <= medium.albedo + 1e-6).all()
    assert light[4, 8].max() > 0.3


def test_every_figure_has_its_module():
    modules = (
        pop_1,
        pop_6,
        pop_7,
        pop_8,
        pop_10,
        pop_11,
        pop_12,
        pop_13,
        pop_14,
        pop_15,
        pop_16,
        pop_17,
    )
    for module in modules:
        name = module.__name__.rpartition(".")[2]
        assert FIGURES[name.replace("_", "-")].source.startswith("Elek2014 ")


@pytest.mark.parametrize("g", [0.0, 0.8])
def test_a_thin_ball_sends_out_what_scatters_once_and_all_of_it(g):
    thin = pop_ball.leaving(2.0, 0.02, g, 400_000)
    area = np.pi * 2.0**2 * np.diff((np.arange(pop_ball.RINGS + 1) / pop_ball.RINGS) ** 2)
    total = float((thin.radiance * area).sum()) * 4.0 * np.pi  # it looks alike from everywhere
    assert total == pytest.approx(4.0 * np.pi * (1.0 - np.exp(-0.04)), rel=0.02)
    # One scattering along the line at distance b: sigma / 4 pi times the integral of 1 / r^2.
    b = 2.0 * (np.arange(pop_ball.RINGS) + 0.5)[4:] / pop_ball.RINGS
    half = np.sqrt(4.0 - b**2)
    t = half[:, None] * ((np.arange(400) + 0.5) / 200.0 - 1.0)
    r = np.hypot(t, b[:, None])
    phase = (1.0 - g * g) / (4.0 * np.pi * (1.0 + g * g - 2.0 * g * t / r) ** 1.5)
    once = 0.02 * (phase / r**2).mean(axis=1) * 2.0 * half
    ratio = thin.radiance[4:].sum() / once.sum()
    assert ratio == pytest.approx(1.0, abs=0.06)


def test_scattered_light_is_judged_where_there_is_air():
    through = np.ones((16, 16, 3), np.float32)
    through[:8] = 0.5
    light = np.full((16, 16, 3), 2.0, np.float32) * (through < 1.0)
    behind = np.full((16, 16, 3), 3.0, np.float32)
    truth = behind + 0.5 * light
    truth[8:] = 100.0  # a sun beside the air
    noisy = Image(truth, {"variance": np.full((16, 16, 3), 0.16, np.float32)})
    told = scattered_errors(light, behind, through, noisy)
    assert told["energy_ratio"] == pytest.approx(2.0)
    assert told["relative_l2"] == pytest.approx(1.0)
    assert told["noise_floor_l2"] == pytest.approx(0.4 / 4.0)  # of blocks of 4 x 4 pixels


def test_air_before_a_sun_is_not_judged():
    through = np.full((64, 64, 3), 0.5, np.float32)
    light = np.full((64, 64, 3), 2.0, np.float32)
    behind = np.ones((64, 64, 3), np.float32)
    truth = behind + 0.5 * light
    behind[:4, :4] = 150.0
    truth[:4, :4] = 130.0  # the sun's own noise
    noisy = Image(truth, {"variance": np.full((64, 64, 3), 0.16, np.float32)})
    told = scattered_errors(light, behind, through, noisy)
    assert told["energy_ratio"] == pytest.approx(2.0)
    assert told["relative_l2"] == pytest.approx(1.0)
