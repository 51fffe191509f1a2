"""Turn what a user wrote into checked values, or say what is wrong with it.

Every function takes the value, and `name`: the key a message must show.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..maths.arrays import F32 as F32
from ..maths.arrays import F64 as F64
from ..maths.arrays import I64 as I64

Vec3 = tuple[float, float, float]
Rgb = tuple[float, float, float]
Bounds = tuple[Vec3, Vec3]


MOST = 1e15
"""Of any number, light and extinction among them: single precision holds its square."""
MOST_M = 1e9
"""Metres of any place and size: single precision holds the square of an area."""
MOST_STOPS = 64.0
MOST_PX = 16384
"""Along a side of an image."""


def number(value: Any, name: str, *, low: float = -MOST, high: float = MOST) -> float:
    """A finite number in [low, high]."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise SceneError(f"{name} must be a number, not {shown(value)}")
    try:
        # Whole numbers of any length are numbers to Python, and no float can hold the largest.
        x = float(value)
    except OverflowError:
        raise SceneError(f"{name} is too large") from None
    if not math.isfinite(x):
        raise SceneError(f"{name} is {x}, it must be finite")
    if not low <= x <= high:
        raise SceneError(f"{name} = {x:g} is outside [{low:g}, {high:g}]")
    return x


def shown(value: Any) -> str:
    """What was written, cut where it is long."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):  # a number of more digits than Python prints
        return f"a {type(value).__name__} too long to show"
    return text if len(text) <= 80 else f"{text[:77]}..."


def _is_list_of(count: int, value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim > 0 and len(value) == count
    return isinstance(value, Sequence) and not isinstance(value, str) and len(value) == count


def stops(value: Any, name: str) -> float | None:
    """A finite number, or None for "auto"."""
    if isinstance(value, str):
        if value != "auto":
            raise SceneError(f'{name} must be a number or "auto", not {shown(value)}')
        return None
    return number(value, name, low=-MOST_STOPS, high=MOST_STOPS)


def vec3(value: Any, name: str, *, high: float = MOST_M) -> Vec3:
    """Three numbers in [-high, high]: by default a place or a size in metres."""
    if not _is_list_of(3, value):
        raise SceneError(f"{name} must be three numbers, not {shown(value)}")
    x, y, z = (number(v, name, low=-high, high=high) for v in value)
    return (x, y, z)


def pair(value: Any, name: str, *, low: float, high: float) -> tuple[float, float]:
    """Two numbers in [low, high]."""
    if not _is_list_of(2, value):
        raise SceneError(f"{name} must be two numbers, not {shown(value)}")
    a, b = (number(v, name, low=low, high=high) for v in value)
    return (a, b)


def size_px(value: Any, name: str) -> tuple[int, int]:
    """Two whole numbers of pixels."""
    low, high = pair(value, name, low=1, high=MOST_PX)
    if low != int(low) or high != int(high):
        raise SceneError(f"{name} must be two whole numbers, not {shown(value)}")
    return (int(low), int(high))


def unit_vec3(value: Any, name: str) -> Vec3:
    """Three numbers, normalised; those of a unit vector stay as they are, to the bit."""
    v = vec3(value, name)
    length = math.sqrt(sum(c * c for c in v))
    if length == 0.0:
        raise SceneError(f"{name} is zero, it must point somewhere")
    # Dividing by a length that is 1 but for rounding would change the last bits at every reading.
    if abs(length - 1.0) < 1e-15:
        return v
    return (v[0] / length, v[1] / length, v[2] / length)


def rgb(value: Any, name: str, *, high: float = MOST) -> Rgb:
    """A linear Rec.709 triple of non-negative numbers; one number stands for grey."""
    # One number is grey, and a boolean is none.
    grey = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    # Colours have a bound of their own, not that of metres.
    triple = vec3([value] * 3 if grey else value, name, high=math.inf)
    if min(triple) < 0.0:
        raise SceneError(f"{name} = {list(triple)} is negative")
    if max(triple) > high:
        raise SceneError(f"{name} = {list(triple)} is above {high:g}")
    return triple


def bounds(value: Any, name: str) -> Bounds:
    """A box ((x0, y0, z0), (x1, y1, z1)) in metres with positive extent on every axis."""
    if not _is_list_of(2, value):
        raise SceneError(f"{name} must be two corners [[x, y, z], [x, y, z]], not {shown(value)}")
    low, high = vec3(value[0], name), vec3(value[1], name)
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise SceneError(f"{name} is empty: {list(low)} to {list(high)}")
    return (low, high)


def text(value: Any, name: str) -> str:
    """A string."""
    if not isinstance(value, str):
        raise SceneError(f"{name} must be text, not {shown(value)}")
    return value


def boolean(value: Any, name: str) -> bool:
    """true or false."""
    if not isinstance(value, (bool, np.bool_)):
        raise SceneError(f"{name} must be true or false, not {shown(value)}")
    return bool(value)


def _is_finite(values: NDArray[Any]) -> bool:
    """Whether all values are finite; of many, by their extremes: no array as large is made."""
    if values.size <= 64:
        return bool(np.isfinite(values).all())
    return bool(values.size == 0 or np.isfinite([values.min(), values.max()]).all())


def at_most(values: NDArray[Any], most: float, name: str) -> None:
    """Raise SceneError where an array holds more than `most`, or less than its negative."""
    if values.size:
        largest = max(float(values.max()), -float(values.min()))
        if largest > most:
            raise SceneError(f"{name} holds {largest:g}, at most {most:g} can be used")


def affine(value: Any, name: str) -> F64:
    """A read-only 4x4 matrix whose last row is 0, 0, 0, 1."""
    matrix = array(value, name, shape=(4, 4), dtype=np.float64)
    x, y, z, w = matrix[3].tolist()
    if max(abs(x), abs(y), abs(z), abs(w - 1.0)) > 1e-6:
        row = ", ".join(f"{v:g}" for v in matrix[3])
        raise SceneError(f"{name} is not affine: its last row is {row}, not 0, 0, 0, 1")
    return matrix


def instance(value: Any, name: str, *kinds: type) -> None:
    """Raise SceneError unless a value is of one of these types."""
    if not isinstance(value, kinds):
        raise SceneError(f"{name} must be of type {_either(kinds)}, not {shown(value)}")


def instances(values: Any, name: str, *kinds: type) -> tuple[Any, ...]:
    """Values of these types as a tuple; one that is a tuple already stays the same object."""
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        raise SceneError(f"{name} must be a sequence of {_either(kinds)}, not {shown(values)}")
    held = values if isinstance(values, tuple) else tuple(values)
    for value in held:
        if not isinstance(value, kinds):
            raise SceneError(f"each of {name} must be of type {_either(kinds)}, not {shown(value)}")
    return held


def optional_function(value: Any, name: str) -> None:
    """Raise SceneError unless a value can be called or is None."""
    if value is not None and not callable(value):
        raise SceneError(f"{name} must be a function, not {shown(value)}")


def _either(kinds: tuple[type, ...]) -> str:
    return " or ".join(getattr(kind, "called", kind.__name__) for kind in kinds)


def path_text(value: Any, name: str) -> str:
    """A path as text."""
    try:
        return os.fsdecode(value)
    except TypeError:
        raise SceneError(f"{name} must be a path, not {shown(value)}") from None


def _of_numbers(value: Any, name: str, dtype: type[np.generic]) -> NDArray[Any]:
    """A contiguous array of a type; no text, nor complex numbers, whose half would be lost."""
    try:
        given = np.asarray(value)
        if given.dtype.kind in "biufO":
            return np.ascontiguousarray(given, dtype=dtype)
    except (TypeError, ValueError):
        pass
    raise SceneError(f"{name} must be an array of real numbers, not {shown(value)}")


def dimensions(value: Any) -> int:
    """How many dimensions an array has; 0 for lists of unequal lengths, which are none."""
    try:
        return np.ndim(value)
    except ValueError:
        return 0


def array(
    value: Any, name: str, *, shape: tuple[int | None, ...], dtype: type[np.generic]
) -> NDArray[Any]:
    """A read-only contiguous array of the given shape (None: any length), all values finite."""
    a = _of_numbers(value, name, dtype)
    # What was checked before stays the same object: that is how a frame knows what did not change.
    is_own = a is value and not a.flags.writeable
    # None in a shape stands for any length.
    fits = a.ndim == len(shape) and all(
        want is None or have == want for have, want in zip(a.shape, shape, strict=True)
    )
    if not fits:
        want_text = "(" + ", ".join("n" if n is None else str(n) for n in shape) + ")"
        raise SceneError(f"{name} has shape {a.shape}, it must be {want_text}")
    if np.issubdtype(dtype, np.floating) and not _is_finite(a):
        raise SceneError(
            f"{name} has {int((~np.isfinite(a)).sum())} values that are NaN or infinite"
        )
    if is_own:
        return a
    # A view is made read-only, so that the caller's own array stays writable.
    if a is value or a.base is not None:
        a = a.view()
    a.flags.writeable = False
    return a


def grid(values: Any, name: str, *, signed: bool = False) -> F32:
    """`array` of a grid's voxels, (z, y, x) or of three channels (z, y, x, 3).

    Raises SceneError where it has none, or where they are negative unless `signed`.
    """
    shape = (None, None, None, 3) if dimensions(values) == 4 else (None, None, None)
    found: F32 = array(values, name, shape=shape, dtype=np.float32)
    if found.size == 0:
        raise SceneError(f"{name} is empty")
    if not signed and float(found.min()) < 0.0:
        raise SceneError(f"{name} is negative (down to {float(found.min()):g})")
    at_most(found, MOST, name)
    return found
