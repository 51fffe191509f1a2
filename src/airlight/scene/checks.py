"""Turn what a user wrote into checked values, or say what is wrong with it.

Every function takes the value, and `name`: the key a message must show.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError

Vec3 = tuple[float, float, float]
Rgb = tuple[float, float, float]
Bounds = tuple[Vec3, Vec3]
F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


def number(value: Any, name: str, *, low: float = -math.inf, high: float = math.inf) -> float:
    """A finite number in [low, high]."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise SceneError(f"{name} must be a number, not {value!r}")
    try:
        x = float(value)
    except OverflowError:
        raise SceneError(f"{name} is too large") from None
    if not math.isfinite(x):
        raise SceneError(f"{name} is {x}, it must be finite")
    if not low <= x <= high:
        raise SceneError(f"{name} = {x:g} is outside [{low:g}, {high:g}]")
    return x


def stops(value: Any, name: str) -> float | None:
    """A finite number, or None for "auto"."""
    if isinstance(value, str):
        if value != "auto":
            raise SceneError(f'{name} must be a number or "auto", not {value!r}')
        return None
    return number(value, name)


def vec3(value: Any, name: str) -> Vec3:
    """Three finite numbers."""
    if isinstance(value, str) or not isinstance(value, (Sequence, np.ndarray)) or len(value) != 3:
        raise SceneError(f"{name} must be three numbers, not {value!r}")
    x, y, z = (number(v, name) for v in value)
    return (x, y, z)


def unit_vec3(value: Any, name: str) -> Vec3:
    """Three numbers, normalised."""
    v = vec3(value, name)
    length = math.sqrt(sum(c * c for c in v))
    if length == 0.0:
        raise SceneError(f"{name} is zero, it must point somewhere")
    return (v[0] / length, v[1] / length, v[2] / length)


def rgb(value: Any, name: str, *, high: float = math.inf) -> Rgb:
    """A linear Rec.709 triple of non-negative numbers; one number stands for grey."""
    grey = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    triple = vec3([value] * 3 if grey else value, name)
    if min(triple) < 0.0:
        raise SceneError(f"{name} = {list(triple)} is negative")
    if max(triple) > high:
        raise SceneError(f"{name} = {list(triple)} is above {high:g}")
    return triple


def bounds(value: Any, name: str) -> Bounds:
    """A box ((x0, y0, z0), (x1, y1, z1)) in metres with positive extent on every axis."""
    if not isinstance(value, (Sequence, np.ndarray)) or len(value) != 2:
        raise SceneError(f"{name} must be two corners [[x, y, z], [x, y, z]], not {value!r}")
    low, high = vec3(value[0], name), vec3(value[1], name)
    if any(a >= b for a, b in zip(low, high, strict=True)):
        raise SceneError(f"{name} is empty: {list(low)} to {list(high)}")
    return (low, high)


def text(value: Any, name: str) -> str:
    """A string."""
    if not isinstance(value, str):
        raise SceneError(f"{name} must be text, not {value!r}")
    return value


def boolean(value: Any, name: str) -> bool:
    """true or false."""
    if not isinstance(value, (bool, np.bool_)):
        raise SceneError(f"{name} must be true or false, not {value!r}")
    return bool(value)


def _is_finite(values: NDArray[Any]) -> bool:
    """Whether all values are finite, by their extremes: no array as large is made."""
    return bool(values.size == 0 or np.isfinite([values.min(), values.max()]).all())


def array(
    value: Any, name: str, *, shape: tuple[int | None, ...], dtype: type[np.generic]
) -> NDArray[Any]:
    """A read-only contiguous array of the given shape (None: any length), all values finite."""
    a = np.ascontiguousarray(value, dtype=dtype)
    # What was checked before stays the same object: that is how a frame knows what did not change.
    is_own = a is value and not a.flags.writeable
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
    if a is value or a.base is not None:
        a = a.view()
    a.flags.writeable = False
    return a
