"""Small lattices' cycles in one dispatch: what dispatches of their own would find."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.commands import Commands
from airlight.scatter import levels as levels_module
from airlight.scatter import small_levels
from airlight.scatter.levels import Levels
from airlight.scatter.schedule import schedule
from airlight.scatter.small_levels import first_small

from .test_propagate import packed_faces  # type: ignore[import-not-found]

COUNT = (16, 9, 10)
SHAPE = COUNT[::-1]
SIGMA_T = np.array([0.1, 0.4, 1.5])
ALBEDO = np.array([1.0, 0.95, 0.6])


def faces(seed: int) -> np.ndarray:
    """Visibility of a lattice with a third of its faces shut or half shut."""
    shut = np.random.default_rng(seed).random((6, *SHAPE))
    return np.where(shut < 0.2, 0.0, np.where(shut < 0.33, 0.5, 1.0))


def sparks() -> np.ndarray:
    source = np.zeros((3, *SHAPE, 4), np.float32)
    source[..., 0] = np.random.default_rng(4).random((3, *SHAPE)) ** 8
    return source


class Solved:
    """Tracks of a stack of lattices, for air and walls after one another."""

    def __init__(self, gpu, lattice, plan, *, is_blocked: bool) -> None:
        self.levels = Levels(gpu, COUNT, 0.5, plan, is_blocked=is_blocked, is_varied=False)
        self.commands, self.lattice = Commands(gpu), lattice
        self.source = lattice(sparks())

    def tracks(self) -> np.ndarray:
        found = []
        for factor, seed in ((1.0, 1), (3.0, 1), (3.0, 2)):
            self.levels.set_air(factor * ALBEDO * SIGMA_T, factor * SIGMA_T)
            white = self.lattice(np.full(SHAPE, 0x00806040, np.uint32))
            self.levels.set_walls(self.commands, self.lattice(packed_faces(faces(seed))), white)
            _, track = self.levels.encode(self.commands, self.source)
            self.commands.submit()
            found.append(track.read().reshape(3, *SHAPE, 4))
        return np.stack(found)


@pytest.mark.parametrize("threads", [8, 64])
@pytest.mark.parametrize("is_blocked", [False, True])
@pytest.mark.parametrize("acceleration", ["cycle", "finish"])
def test_one_dispatch_finds_what_many_do(
    gpu, lattice, monkeypatch, acceleration, is_blocked, threads
):
    plan = schedule(acceleration, 8, COUNT)
    with monkeypatch.context() as apart:
        apart.setattr(levels_module, "first_small", lambda counts: None)
        want = Solved(gpu, lattice, plan, is_blocked=is_blocked).tracks()
    monkeypatch.setattr(small_levels, "_CPU_THREADS", threads)
    monkeypatch.setattr(small_levels, "_THREADS", threads)
    got = Solved(gpu, lattice, plan, is_blocked=is_blocked).tracks()
    assert np.linalg.norm(got - want) < 1e-6 * np.linalg.norm(want)
    np.testing.assert_allclose(got, want, atol=1e-6 * want.max())
    # Media and walls do count.
    assert np.linalg.norm(got[1] - got[0]) > 0.01 * np.linalg.norm(got[0])
    if is_blocked:
        assert np.linalg.norm(got[2] - got[1]) > 0.01 * np.linalg.norm(got[1])


def test_cycles_of_small_lattices_take_few_dispatches(gpu, lattice, monkeypatch):
    calls = []
    dispatch = small_levels.ComputePass.dispatch

    def counted(self, *args, **values):
        calls.append(self.label)
        return dispatch(self, *args, **values)

    monkeypatch.setattr(small_levels.ComputePass, "dispatch", counted)
    levels = Levels(
        gpu, COUNT, 0.5, schedule("cycle", 12, COUNT), is_blocked=False, is_varied=False
    )
    levels.set_air(ALBEDO * SIGMA_T, SIGMA_T)
    commands = Commands(gpu)
    levels.encode(commands, lattice(sparks()))
    commands.submit()
    assert calls.count("_Small") == 3  # once a cycle
    assert len(calls) < 40


def test_which_lattices_are_small():
    assert first_small([(32, 18, 20), (16, 9, 10), (8, 5, 5), (4, 3, 3)]) == 2
    assert first_small([(8, 8, 8), (4, 4, 4)]) == 1  # the finest never is
    assert first_small([(8, 8, 8)]) is None
    assert first_small([(64, 64, 64), (32, 32, 32)]) is None


def test_small_lattices_have_no_light_twice(gpu, owned):
    levels = owned(
        Levels(gpu, COUNT, 0.5, schedule("cycle", 12, COUNT), is_blocked=True, is_varied=False)
    )
    fine, *small = levels.levels
    assert [level.count for level in small] == [(8, 5, 5), (4, 3, 3)]
    assert fine.sum.nbytes == 16 * 3 * fine.cells
    for level in small:
        light = (level.sum, level.spare, level.track, level.answer, level.source)
        assert {buffer.nbytes for buffer in light} == {16}
        # Their walls are worked out where they are.
        assert (level.packs.nbytes, level.face_visibility.nbytes) == (
            64 * level.cells,
            8 * level.cells,
        )
