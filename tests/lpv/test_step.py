"""The kernels of one step: their constants, which one a lattice gets, and that they are alike."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.gpu.lanes import has_row_lanes
from airlight.gpu.memory import buffer_of
from airlight.lpv import step
from airlight.lpv.step import CHANNELS, Step, StepKind, hop_constants, takes_rows
from airlight.lpv.storage import FLOAT, FORMATS
from airlight.maths import lattice6


@pytest.fixture
def stepped(gpu, commands, owned):
    """stepped(kind, count, added=...) -> the state (3, cells, 4) after a step of a random one."""

    def make(kind, count, added=None):
        rng, cells = np.random.default_rng(5), int(np.prod(count))
        state = rng.normal(size=(CHANNELS, cells, 4)).astype(np.float32)
        faces = rng.integers(0, 1 << 32, cells * 8, dtype=np.uint32)
        before, after = (owned(buffer_of(gpu, "state", state)) for _ in range(2))
        more = None if added is None else owned(buffer_of(gpu, "added", added))
        bound = owned(buffer_of(gpu, "faces", faces))
        Step(gpu, count, kind).encode(commands, before, after, bound, added=more)
        commands.submit()
        return after.read().reshape(state.shape)

    return make


@pytest.mark.parametrize("kept", [0.0, 0.25, 0.75])
def test_five_numbers_are_all_six_matrices(kept):
    n = hop_constants(kept)
    for hop in lattice6.hops("centroid", kept):
        d = np.array(hop.offset)
        along, across = np.outer(d, d), np.eye(3) - np.outer(d, d)
        matrix = np.zeros((4, 4))
        matrix[0, 0] = n["MEAN_TO_MEAN"]
        matrix[0, 1:], matrix[1:, 0] = n["FLUX_TO_MEAN"] * d, n["MEAN_TO_FLUX"] * d
        matrix[1:, 1:] = n["FLUX_ALONG"] * along + n["FLUX_ACROSS"] * across
        np.testing.assert_allclose(matrix, hop.matrix, atol=1e-12)


@pytest.mark.parametrize("scheme", ["centroid", "paper"])
@pytest.mark.parametrize("is_blocked", [False, True])
@pytest.mark.parametrize("count", [(8, 8, 9), (6, 5, 18), (16, 3, 2), (40, 1, 5), (70, 2, 2)])
def test_rows_of_lanes_make_the_light_of_single_cells(
    gpu, stepped, monkeypatch, scheme, is_blocked, count
):
    if not has_row_lanes(gpu):
        pytest.skip("this driver's lanes are not in rows")
    kind = StepKind(scheme, is_blocked=is_blocked, is_reflecting=is_blocked)
    assert takes_rows(gpu, count, FLOAT)
    in_rows = stepped(kind, count)
    monkeypatch.setattr(step, "takes_rows", lambda *_: False)
    one_by_one = stepped(kind, count)
    # The same sums in the same order, but for what compilers fuse.
    np.testing.assert_allclose(in_rows, one_by_one, atol=2e-6 * np.abs(one_by_one).max())


@pytest.mark.both_paths
@pytest.mark.parametrize("scheme", ["centroid", "paper"])
@pytest.mark.parametrize("count", [(6, 4, 3), (5, 3, 4)])
@pytest.mark.parametrize("is_blocked", [False, True])
def test_what_is_added_comes_on_top(stepped, scheme, count, is_blocked):
    more = np.random.default_rng(2).normal(size=(CHANNELS, int(np.prod(count)), 4))
    more = more.astype(np.float32)
    alone = stepped(StepKind(scheme, is_blocked, is_blocked), count)
    both = stepped(StepKind(scheme, is_blocked, is_blocked, is_added=True), count, added=more)
    np.testing.assert_allclose(both - alone, more, atol=2e-5)
    assert np.abs(alone).max() > 0.1


@pytest.mark.parametrize(
    ("count", "storage"), [((5, 4, 4), "float32"), ((4, 4, 4), "float16"), ((4, 4, 4), "8bit")]
)
def test_odd_rows_and_other_storage_take_single_cells(gpu, count, storage):
    assert not takes_rows(gpu, count, FORMATS[storage])
