"""Values between keyframes: steps, straight lines, smooth curves, and turns of a sphere.

Each function takes the times (K,) of the keyframes, rising, and one time; outside them the first
or the last value holds.
"""

from __future__ import annotations

import numpy as np

from .arrays import F64


def segment(times: F64, time: float) -> tuple[int, float]:
    """(k, u): the time lies the share u in [0, 1] of the way from keyframe k to k + 1.

    With one keyframe, (0, 0).
    """
    # Before the first keyframe and after the last, their values hold.
    if len(times) == 1 or time <= times[0]:
        return 0, 0.0
    if time >= times[-1]:
        return len(times) - 2, 1.0
    k = int(np.searchsorted(times, time, side="right")) - 1
    return k, float((time - times[k]) / (times[k + 1] - times[k]))


def step(times: F64, values: F64, time: float) -> F64:
    """The value (...) of the last keyframe that has begun."""
    k, u = segment(times, time)
    return np.asarray(values[k + 1] if u >= 1.0 else values[k])


def linear(times: F64, values: F64, time: float) -> F64:
    """On the straight line between two keyframes; values (K, ...)."""
    k, u = segment(times, time)
    if u == 0.0:
        return np.asarray(values[k])
    return np.asarray((1.0 - u) * values[k] + u * values[k + 1])


def slerp(times: F64, values: F64, time: float) -> F64:
    """Unit quaternions (K, 4) along great arcs, the shorter way round (Shoemake1985)."""
    # The two keyframes around the time.
    k, u = segment(times, time)
    a = np.asarray(values[k])
    if u == 0.0:
        return a
    b = np.asarray(values[k + 1])
    cosine = float(a @ b)
    # q and -q turn alike: the nearer of both gives the shorter way round.
    if cosine < 0.0:
        b, cosine = -b, -cosine
    # Too near for a division by the sine: a line is exact enough.
    if cosine > 1.0 - 1e-9:
        return unit_quaternion((1.0 - u) * a + u * b)
    angle = np.arccos(min(cosine, 1.0))
    turned = (np.sin((1.0 - u) * angle) * a + np.sin(u * angle) * b) / np.sin(angle)
    return unit_quaternion(turned)


def smooth(times: F64, values: F64, time: float, speeds: F64 | None = None) -> F64:
    """Catmull-Rom through the values (K, ...), for keyframes at any distance (Barry1988).

    A keyframe's speed is that of the parabola through it and its neighbours; at both ends it is
    the mean speed of the first and of the last segment, so that two keyframes make a line.
    `speeds`, as of `catmull_rom_speeds`, are computed where they are not known.
    """
    k, u = segment(times, time)
    if len(times) == 1:
        return np.asarray(values[0])
    if speeds is None:
        speeds = catmull_rom_speeds(times, values)
    # Hermite's cubic has them at both ends.
    span = float(times[k + 1] - times[k])
    return hermite(values[k], span * speeds[k], values[k + 1], span * speeds[k + 1], u)


def catmull_rom_speeds(times: F64, values: F64) -> F64:
    """The speed at each of two keyframes or more (K, ...), of the values by time."""
    # Speeds at the keyframes from those of the segments beside, the shorter segment's counting
    # more.
    steps = np.diff(times).reshape(-1, *[1] * (values.ndim - 1))
    slopes = np.diff(values, axis=0) / steps
    return np.concatenate(
        [slopes[:1], slopes[-1:]]
        if len(times) == 2
        else [
            slopes[:1],
            (slopes[:-1] * steps[1:] + slopes[1:] * steps[:-1]) / (steps[1:] + steps[:-1]),
            slopes[-1:],
        ]
    )


def cubic_spline(times: F64, values: F64, time: float) -> F64:
    """glTF 2.0, appendix C.5: values (K, 3, ...) of in-tangent, value and out-tangent."""
    k, u = segment(times, time)
    if len(times) == 1:
        return np.asarray(values[0, 1])
    span = float(times[k + 1] - times[k])
    start, end = values[k], values[k + 1]
    return hermite(start[1], span * start[2], end[1], span * end[0], u)


def hermite(start: F64, out: F64, end: F64, into: F64, u: float) -> F64:
    """The cubic from `start` to `end` with derivatives `out` and `into` by u."""
    # Hermite's four basis polynomials.
    u2, u3 = u * u, u * u * u
    return np.asarray(
        (2.0 * u3 - 3.0 * u2 + 1.0) * start
        + (u3 - 2.0 * u2 + u) * out
        + (3.0 * u2 - 2.0 * u3) * end
        + (u3 - u2) * into
    )


def unit_quaternion(q: F64) -> F64:
    """Of length 1; one that is nothing turns nothing."""
    length = float(np.linalg.norm(q))
    return np.asarray(q / length) if length > 0.0 else np.array([0.0, 0.0, 0.0, 1.0])
