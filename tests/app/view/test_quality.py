"""When images are coarse, when they are refined, and how resolution follows the time taken."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.app.view.quality import SETTLE_S, Plan, Quality

FULL = (800, 450)


def test_coarse_while_moving_then_all_samples_then_nothing():
    quality = Quality(is_cpu=True, samples=3)
    first = quality.plan(0.0, FULL, changed=True)
    assert first.size == (400, 225)
    quality.took(10.0, first)  # four times as long would do
    between = quality.plan(0.1, FULL, changed=False)
    assert between.is_moving
    assert between.sample is None  # nothing new to draw, too early to refine
    still = [quality.plan(SETTLE_S + 0.1 * i, FULL, changed=False) for i in range(1, 6)]
    assert [plan.sample for plan in still] == [0, 1, 2, None, None]
    assert all(plan.size == FULL for plan in still)
    assert quality.share == 1.0


def test_a_change_restarts():
    quality = Quality(is_cpu=False, samples=3)
    quality.plan(0.0, FULL, changed=True)
    quality.plan(1.0, FULL, changed=False)
    assert quality.plan(1.1, FULL, changed=True).is_moving
    assert quality.plan(2.0, FULL, changed=False).sample == 0


def test_a_resized_window_restarts():
    quality = Quality(is_cpu=False, samples=2)
    for now in (1.0, 2.0, 3.0):
        quality.plan(now, FULL, changed=False)
    assert quality.plan(4.0, (640, 480), changed=False).sample == 0


def test_a_hand_at_work_holds_fine_images_back_and_loses_none():
    quality = Quality(is_cpu=True, samples=4)
    assert quality.plan(1.0, FULL, changed=False).sample == 0
    assert quality.plan(1.1, FULL, changed=False, is_busy=True).sample is None
    assert quality.plan(1.2, FULL, changed=False).sample == 1
    quality.plan(2.0, FULL, changed=True)
    held = quality.plan(3.0, FULL, changed=False, is_busy=True)  # a held button, at rest
    assert held.is_moving
    assert held.sample is None
    assert quality.plan(3.1, FULL, changed=False).sample == 0


def test_a_gpu_starts_at_full_size():
    assert Quality(is_cpu=False).plan(0.0, FULL, changed=True).size == FULL


def moving(quality: Quality, cost_ms_per_pixel: float, frames: int, fixed_ms: float = 0.0) -> float:
    """Milliseconds of the last of `frames` on a machine of this speed."""
    ms = 0.0
    for frame in range(frames):
        plan = quality.plan(0.01 * frame, FULL, changed=True)
        ms = fixed_ms + cost_ms_per_pixel * plan.size[0] * plan.size[1]
        quality.took(ms, plan)
    return ms


def test_a_slow_machine_comes_above_ten_frames_a_second_soon():
    per_pixel = 900.0 / (FULL[0] * FULL[1])  # 0.9 s a full frame
    assert moving(Quality(is_cpu=True), per_pixel, frames=6) < 100.0
    assert moving(Quality(is_cpu=True), per_pixel, frames=60) < 100.0


def test_one_slow_frame_is_no_slow_machine():
    quality = Quality(is_cpu=True)
    for ms in (30.0, 900.0, 30.0, 60.0, 900.0, 60.0):
        quality.took(ms, quality.plan(0.0, FULL, changed=True))
    assert quality.scale == 2.0


def test_a_fast_machine_comes_to_full_size():
    quality = Quality(is_cpu=True)
    moving(quality, 20.0 / (FULL[0] * FULL[1]), frames=100)
    assert quality.scale == 1.0


def test_resolution_does_not_swing():
    quality, scales = Quality(is_cpu=True), []
    for frame in range(80):
        plan = quality.plan(0.01 * frame, FULL, changed=True)
        quality.took(10.0 + 300.0 * plan.size[0] * plan.size[1] / (FULL[0] * FULL[1]), plan)
        scales.append(quality.scale)
    assert len(set(scales[20:])) == 1


def test_where_fewer_pixels_save_nothing_there_are_no_fewer():
    quality = Quality(is_cpu=True)
    moving(quality, 0.0, frames=30, fixed_ms=400.0)
    assert quality.scale == 2.0
    # Another window, another try; what its pixels cost counts again.
    assert quality.plan(9.0, (3, 2), changed=True).size == (2, 1)
    moving(quality, 2000.0 / (FULL[0] * FULL[1]), frames=30, fixed_ms=40.0)
    assert quality.scale > 4.0


@pytest.mark.parametrize("is_alone", [False, True])
def test_stills_that_would_block_the_window_end_and_never_become_coarser(is_alone):
    quality, now = Quality(is_cpu=False, samples=12), 1.0
    quality.is_alone = is_alone
    plans = []
    for _ in range(14):
        now += 0.1
        plans.append(quality.plan(now, FULL, changed=False))
        if plans[-1].sample is not None:
            quality.took(200.0 * plans[-1].size[0] ** 2 / FULL[0] ** 2, plans[-1])
    assert {plan.size for plan in plans} == {FULL}
    # Someone else goes on, or these do, however long they take.
    assert [plan.sample for plan in plans[:2]] == [0, 1]
    assert [plan.sample for plan in plans[2:]] == (
        [*range(2, 12), None, None] if is_alone else [None] * 12
    )
    assert quality.is_done
    assert quality.is_coarse is not is_alone
    assert quality.full_samples == (12 if is_alone else 2)


@pytest.mark.parametrize("slow_ms", [200.0, 2000.0])
@pytest.mark.parametrize("is_rough", [False, True])
def test_a_view_at_rest_is_as_fine_as_the_moving_image(is_rough, slow_ms):
    """Where it could not be refined as quickly as a hand needs it, that image is what stays."""
    quality = Quality(is_cpu=True)
    plan = quality.plan(0.0, FULL, changed=True)
    for ms in (160.0, slow_ms):  # others are at work
        plan = quality.plan(0.0, FULL, changed=True)
        quality.took(ms, plan)
    assert quality.coarse(FULL) < plan.size == (400, 225)
    still = quality.plan(1.0, FULL, changed=False, is_rough=is_rough)
    assert still == Plan(plan.size, 0 if is_rough else None)
    quality.took(300.0, still)
    assert quality.plan(1.1, FULL, changed=False) == Plan(plan.size, None)
    assert quality.is_done
    assert quality.is_coarse
    assert quality.full_samples == 0
    # Where the machine has time again, it is refined.
    for frame in range(8):
        quality.took(20.0, quality.plan(2.0 + frame, FULL, changed=True))
        still = quality.plan(2.5 + frame, FULL, changed=False)
    assert still.sample == 0
    assert still.size[0] > plan.size[0]


@pytest.mark.parametrize("seed", range(100))
def test_no_view_at_rest_is_coarser_than_what_moved(seed):
    rng = np.random.default_rng(seed)
    quality, now, seen = Quality(is_cpu=bool(seed % 2), samples=int(rng.integers(1, 9))), 0.0, 0
    for _ in range(300):
        now += float(rng.choice([0.01, 0.1, 0.5]))
        changed, is_rough = bool(rng.random() < 0.2), bool(rng.random() < 0.3)
        plan = quality.plan(now, FULL, changed=changed, is_rough=is_rough)
        if plan.sample is not None:
            assert plan.is_moving or plan.size[0] >= seen
            seen = plan.size[0]
            quality.took(float(10.0 ** rng.uniform(0.0, 3.0)), plan)


def test_a_view_at_rest_begins_as_fine_as_moving_images_say():
    quality = Quality(is_cpu=True)
    assert moving(quality, 900.0 / (FULL[0] * FULL[1]), frames=20) < 100.0
    still = quality.plan(5.0, FULL, changed=False)
    assert 30.0 < 900.0 * still.size[0] * still.size[1] / (FULL[0] * FULL[1]) < 100.0


@pytest.mark.parametrize("seed", range(300))
def test_a_view_at_rest_ends_at_full_size(seed):
    """Whatever frames took, whenever it moved, and whoever was at work before, if nobody else has
    an image of full size."""
    rng = np.random.default_rng(seed)
    quality, now = Quality(is_cpu=bool(seed % 2), samples=int(rng.integers(1, 9))), 0.0
    quality.is_alone = True
    for _ in range(int(rng.integers(0, 80))):
        now += float(rng.choice([0.01, 0.1, 0.5]))
        full = FULL if rng.random() < 0.97 else (300, 200)
        plan = quality.plan(
            now, full, changed=bool(rng.random() < 0.3), is_busy=bool(rng.random() < 0.2)
        )
        if plan.sample is not None:
            quality.took(float(10.0 ** rng.uniform(0.0, 4.5)), plan)
    quality.plan(now, FULL, changed=True)  # and from now on nothing moves
    plans, now = [], now + SETTLE_S
    for _ in range(120):
        now += 0.1
        plans.append(quality.plan(now, FULL, changed=False))
        if plans[-1].sample is not None:
            quality.took(float(10.0 ** rng.uniform(0.0, 4.5)), plans[-1])
        assert quality.share < 1.0 or plans[-1].size == FULL
    assert plans[-1] == Plan(FULL, None)
    assert quality.share == 1.0
    drawn = [plan for plan in plans if plan.sample is not None]
    assert [plan.sample for plan in drawn[-quality.samples :]] == list(range(quality.samples))


@pytest.mark.parametrize(("full_ms", "is_sharp"), [(140.0, True), (160.0, False)])
def test_full_size_is_tried_at_every_rest_where_a_hand_hardly_waits_for_it(full_ms, is_sharp):
    quality, now = Quality(is_cpu=True), 0.0
    for _ in range(3):
        plan = quality.plan(now, FULL, changed=True)
        quality.took(full_ms * plan.size[0] ** 2 / FULL[0] ** 2, plan)
        plans = []
        for _ in range(4):
            now += 0.3
            plans.append(quality.plan(now, FULL, changed=False))
            if plans[-1].sample is not None:
                quality.took(full_ms * plans[-1].size[0] ** 2 / FULL[0] ** 2, plans[-1])
        assert (plans[0].size == FULL) is is_sharp
        # Two slow ones are enough; what is finer follows in the background.
        if is_sharp:
            assert [plan.sample for plan in plans] == [0, 1, None, None]
            assert (quality.full_samples, quality.is_coarse) == (2, True)
        now += 1.0


def test_slow_stills_do_not_make_moving_coarser():
    quality = Quality(is_cpu=True)
    still = quality.plan(5.0, FULL, changed=False)
    quality.took(2000.0, still)
    assert quality.scale == 2.0
