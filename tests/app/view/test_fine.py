"""The finest image of a still view: what it is told, and that it is what it says."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from airlight.app.view import fine as view_fine
from airlight.app.view.build import Turns
from airlight.app.view.fine import Fine, Seen, Shot
from airlight.app.view.finer import finer_settings
from airlight.display.presenter import Look
from airlight.gather.solver import GatherSolver
from airlight.rendering import Renderer
from airlight.scene import Medium
from airlight.scene.io import load
from airlight.techniques import checked_settings
from small_viewer import SETTINGS as SMALL

SIZE = (24, 14)


@pytest.fixture
def fine(gpu):
    made = Fine(gpu, Turns())
    yield made
    made.drop()


def until(is_so) -> None:
    end = time.monotonic() + 240.0
    while not is_so():
        assert time.monotonic() < end
        time.sleep(0.01)


BOX = Path(__file__).with_name("view_box.toml")


def finer_of(technique: str, *, fog: float = 0.0, sky: bool = True, **given):
    scene = load(BOX)
    scene = replace(
        scene,
        environment=scene.environment if sky else None,
        medium=Medium((fog,) * 3) if fog else None,
    )
    return finer_settings(checked_settings(technique, scene, given), scene, is_cpu=True)


def test_air_is_marched_whole():
    air = {"march_resolution": "full", "shaft_resolution": "full"}
    assert finer_of("auto", fog=0.1) == air
    assert finer_of("auto", fog=0.1, shaft_resolution="full") == {"march_resolution": "full"}
    assert finer_of("pop", fog=0.1)["march"] == "full"


def test_a_sky_gets_a_larger_lattice_where_nothing_propagates_on_it():
    assert finer_of("direct") == {"resolution": 64}
    assert finer_of("direct", resolution=160) == {}  # enough is enough
    assert finer_of("lpv") == finer_of("auto") == {"gather": "always"}
    assert finer_of("lpv", gather="off") == finer_of("lpv", gather="always") == {}
    assert finer_of("direct", sky=False) == {}


def test_it_is_the_image_that_its_settings_make(gpu, fine):
    scene = load(BOX)
    settings = {**SMALL, "sky_lights": 8, "resolution": 12}

    def make() -> Renderer:
        return Renderer(scene, "direct", SIZE, settings=settings)

    shot = Shot(scene, SIZE, Look(), "rgba8unorm")
    fine.begin(make, shot)
    assert not fine.is_shown
    until(lambda: fine.samples >= view_fine.SHOWN_FROM)
    assert fine.is_shown
    until(lambda: fine.has_ended)
    fine.begin(make, shot)  # all done: nothing more happens
    assert fine.samples == view_fine.SAMPLES
    assert not fine.has_ended
    mean = fine.presenter._combine.image.read()[..., :3]
    with make() as renderer:
        expected = renderer.frame(samples=view_fine.SAMPLES).radiance
    assert np.abs(mean - expected).max() < 1e-4 * expected.max()


def test_what_moves_takes_it_back_and_only_samples_are_made_again(gpu, fine):
    scene, made = load(BOX), []

    def make() -> Renderer:
        made.append(1)
        return Renderer(scene, "direct", SIZE, settings=SMALL)

    fine.begin(make, Shot(scene, SIZE, Look(), "rgba8unorm"))
    until(lambda: fine.samples > 1)
    with fine._turns.frame():  # as a session does
        fine.moved()
    assert not fine.is_shown
    held = fine.samples
    time.sleep(0.05)
    assert fine.samples == held == 0
    still = Shot(scene, SIZE, Look(), "rgba8unorm")
    until(lambda: (fine.begin(make, still), fine.is_shown)[1])
    assert len(made) == 1
    fine.halt()
    assert fine.drawn is not None


def test_what_takes_too_much_memory_is_given_up_with_a_reason(gpu, fine, monkeypatch):
    monkeypatch.setattr(view_fine, "MOST_BYTES", 1 << 10)
    before, scene, made = gpu.allocated_bytes, load(BOX), []

    def make() -> Renderer:
        made.append(1)
        return Renderer(scene, "direct", SIZE, settings=SMALL)

    shot = Shot(scene, SIZE, Look(), "rgba8unorm")
    fine.begin(make, shot)
    until(lambda: fine.has_ended)
    for _ in range(3):
        fine.begin(make, shot)
    assert "no finer image: it would take" in fine.message
    assert not fine.is_shown
    assert len(made) == 1
    assert gpu.allocated_bytes == before


# Each sample that gathers is of two images, and counts with the second.
GATHERED = ((1,), (1,), (2,), (2,), (3,), (3,), (4,))


@pytest.mark.parametrize(
    ("seen", "gather", "expected"),
    [
        # Nobody refines full size: plain samples at once, once there are more than seen; then
        # those that gather, as soon as they are better.
        (Seen(0, is_refined=False), "still", [1, 2, 2, *GATHERED]),
        (Seen(1, is_refined=False), "still", [None, 2, 2, *GATHERED]),
        # As many plain samples as there would be are not drawn again.
        (Seen(2, is_refined=False), "still", [None, *GATHERED]),
        # Others that gather are given up for many, those that do not for one.
        (Seen(16), "still", [None, *GATHERED]),
        (Seen(16, gathers=True), "still", [*[None] * 7, (4,)]),
        # Where nobody gathers all samples are alike.
        (Seen(2, is_refined=False), "off", [None, None, (3,), (4,)]),
        (Seen(0, is_refined=False), "off", [(1,), (2,), (3,), (4,)]),
    ],
)
def test_it_is_shown_as_soon_as_it_is_better(gpu, fine, monkeypatch, seen, gather, expected):
    """After each image: how many plain ones are shown, (how many) of the others, or None."""
    monkeypatch.setattr(view_fine, "SAMPLES", 4)
    monkeypatch.setattr(view_fine, "SHOWN_FROM", 4)
    scene, fold, shown = load(BOX), fine._fold, []

    def folded(*given, is_plain):
        fold(*given, is_plain=is_plain)
        now = fine.shown[1] if fine.is_shown else None
        shown.append(now if fine.shown[0] is fine._plain_presenter or now is None else (now,))

    monkeypatch.setattr(fine, "_fold", folded)
    settings = {**SMALL, "gather": gather, "gather_rays": 1}
    fine.begin(
        lambda: Renderer(scene, "lpv", SIZE, settings=settings),
        Shot(scene, SIZE, Look(), "rgba8unorm"),
        seen,
    )
    until(lambda: fine.has_ended)
    assert shown == expected


def test_images_of_a_sample_share_what_was_gathered(gpu, fine, monkeypatch):
    """Two images with jitters of their own, the one nearest to pixels' middles first."""
    monkeypatch.setattr(view_fine, "SAMPLES", 4)
    scene, aimed, gathers = load(BOX), [], []
    gathered = GatherSolver._gathered
    monkeypatch.setattr(
        GatherSolver,
        "_gathered",
        lambda self, *given: (gathers.append(1), gathered(self, *given))[1],
    )

    def made() -> Renderer:
        r = Renderer(scene, "lpv", SIZE, settings={**SMALL, "gather": "still", "gather_rays": 1})
        aim = r.aim
        r.aim = lambda camera, px, *at: (aimed.append((px, *at)), aim(camera, px, *at))
        return r

    fine.begin(made, Shot(scene, SIZE, Look(), "rgba8unorm"), Seen(16))
    until(lambda: fine.has_ended)
    assert [at for _, *at in aimed] == [[k, (i, 2)] for k in range(4) for i in range(2)]
    away = [float(np.hypot(*px)) for px, *_ in aimed]
    assert all(first <= second for first, second in zip(away[::2], away[1::2], strict=True))
    assert len({px for px, *_ in aimed}) == 8
    assert len(gathers) == 4
