"""Values a user wrote: accepted as what they mean, or refused in exact words."""

from __future__ import annotations

import numpy as np
import pytest

from airlight.errors import SceneError
from airlight.scene import checks


def refusal(check, *arguments, **options) -> str:
    with pytest.raises(SceneError) as caught:
        check(*arguments, **options)
    return str(caught.value)


def test_numbers():
    assert checks.number(3, "x") == 3.0
    assert isinstance(checks.number(np.float32(0.5), "x"), float)
    assert checks.number(1, "x", low=0, high=1) == 1.0


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("3", "x must be a number, not '3'"),
        (True, "x must be a number, not True"),
        (None, "x must be a number, not None"),
        (float("nan"), "x is nan, it must be finite"),
        (float("-inf"), "x is -inf, it must be finite"),
        (10**400, "x is too large"),
        (2, "x = 2 is outside [0, 1]"),
        (-0.5, "x = -0.5 is outside [0, 1]"),
    ],
)
def test_what_is_not_a_number(value, expected):
    assert refusal(checks.number, value, "x", low=0, high=1) == expected


def test_vectors():
    assert checks.vec3(np.array([1, 2, 3]), "v") == (1.0, 2.0, 3.0)
    assert checks.unit_vec3((0, 3, 4), "v") == (0.0, 0.6, 0.8)
    assert refusal(checks.vec3, [1, 2], "v") == "v must be three numbers, not [1, 2]"
    assert refusal(checks.vec3, "abc", "v") == "v must be three numbers, not 'abc'"
    assert refusal(checks.vec3, [1, 2, "3"], "v") == "v must be a number, not '3'"
    assert refusal(checks.unit_vec3, (0, 0, 0), "v") == "v is zero, it must point somewhere"


def test_colours():
    assert checks.rgb(0.5, "c") == (0.5, 0.5, 0.5)
    assert checks.rgb([1, 2, 3], "c") == (1.0, 2.0, 3.0)
    assert refusal(checks.rgb, -1, "c") == "c = [-1.0, -1.0, -1.0] is negative"
    assert refusal(checks.rgb, [0, 2, 0], "c", high=1.0) == "c = [0.0, 2.0, 0.0] is above 1"


def test_boxes():
    assert checks.bounds([[0, 0, 0], [1, 2, 3]], "b") == ((0, 0, 0), (1, 2, 3))
    assert refusal(checks.bounds, [0, 1, 2], "b").startswith("b must be two corners")
    assert refusal(checks.bounds, [[0, 0, 0], [1, 0, 1]], "b") == (
        "b is empty: [0.0, 0.0, 0.0] to [1.0, 0.0, 1.0]"
    )


def test_words_and_truths():
    assert checks.text("a", "t") == "a"
    assert checks.boolean(np.True_, "t") is True
    assert refusal(checks.text, 3, "t") == "t must be text, not 3"
    assert refusal(checks.boolean, 1, "t") == "t must be true or false, not 1"


def test_arrays_are_read_only_copies_or_views():
    mine = np.zeros((2, 3), np.float32)
    kept = checks.array(mine, "a", shape=(None, 3), dtype=np.float32)
    assert not kept.flags.writeable
    assert mine.flags.writeable, "the caller's own array stays his"
    assert checks.array(kept, "a", shape=(None, 3), dtype=np.float32) is kept, "checked before"
    assert checks.array([[1, 2, 3]], "a", shape=(1, 3), dtype=np.float32).dtype == np.float32


def test_arrays_of_another_shape_or_with_nan():
    assert refusal(checks.array, np.zeros((2, 2)), "a", shape=(None, 3), dtype=np.float32) == (
        "a has shape (2, 2), it must be (n, 3)"
    )
    bad = np.array([[0, np.nan, np.inf]])
    assert refusal(checks.array, bad, "a", shape=(None, 3), dtype=np.float32) == (
        "a has 2 values that are NaN or infinite"
    )


def test_a_unit_vector_read_again_is_the_same_to_the_bit():
    """So that a scene written and read again has the same light."""
    rng = np.random.default_rng(5)
    for v in rng.normal(size=(300, 3)):
        once = checks.unit_vec3(v, "v")
        assert checks.unit_vec3(once, "v") == once
    assert checks.unit_vec3((0.0, 1.0 + 1e-9, 0.0), "v") == (0.0, 1.0, 0.0)


def test_lists_of_unequal_lengths_have_no_dimensions():
    assert checks.dimensions([[[1.0]]]) == 3
    assert checks.dimensions([[1.0, 2.0], [3.0]]) == 0
