"""Fewer rays of a point for later segments: which go on, and what each of them counts."""

from itertools import pairwise

import numpy as np
import pytest

from airlight.gather.thinning import counts, going_on, rays_of


@pytest.mark.parametrize("rays", [1, 2, 5, 16, 100])
def test_all_paths_count_as_much_as_there_were_rays(rays):
    weight = 1.0
    for segment in range(6):
        assert rays_of(segment, rays) * weight == pytest.approx(rays)
        weight *= counts(segment, rays)
    assert rays_of(6, rays) >= 1


@pytest.mark.parametrize("batch", [4, 7, 16])
def test_which_rays_go_on_does_not_depend_on_batches(batch):
    sample = range(48, 64)
    batches = [range(k, min(k + batch, sample.stop)) for k in range(48, 64, batch)]
    for segment in range(4):
        found = np.concatenate([list(going_on(b, sample, segment)) for b in batches])
        np.testing.assert_array_equal(found, sample[: rays_of(segment, 16)])
    # None goes on that did not reach the segment before.
    for numbers in batches:
        ways = [going_on(numbers, sample, segment) for segment in range(4)]
        assert all(b.start == a.start and b.stop <= a.stop for a, b in pairwise(ways))
