"""What a homogeneous medium does to one hop, as the numbers that the step's shader reads.

M takes the state on by one iteration, T gives the track length that it leaves behind; both are
linear and local, so one kernel serves both with other numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SettingsError
from ..gpu.layout import Struct, f32, u32, vec3u, vec4f
from ..maths.lattice26 import RHO, hops, mean_hop_length
from ..maths.lattice26_levels import coarse_absorption_depth
from ..maths.lattice26_walls import REFLECTED_TRACK, returned_sharpness
from ..maths.medium import mean_transmittance

F64 = NDArray[np.float64]
CHANNELS = 3
_FIRST = (0, 6, 18)  # one hop of each kind
_COUNTS = np.array([6.0, 12.0, 8.0])


class StepCoefficients(Struct):
    """One channel's numbers; x, y, z are the three kinds of hop: face, edge, corner."""

    gain = vec4f("on what is read: even, direct, direct, direct")
    even = vec4f("arriving power -> A; w: own A -> A")
    direct = vec4f("arriving power -> B, per offset; w: own B -> B")
    kept_even = vec4f("own open hop -> own A; w: least reflectance of negative power")
    kept_direct = vec4f("-> own B, per offset")
    stopped_even = vec4f("own stopped hop -> own A, before it is reflected")
    stopped_direct = vec4f("-> own B, per offset")
    returned_even = vec4f("own reflected hop -> own A")
    returned_direct = vec4f("-> own B, per normal")


class StepParams(Struct):
    """The lattice's size, and which of the coefficients a step uses; for all kernels of steps."""

    count = vec3u("cells")
    row = u32("of the coefficients, for channel 0")
    slabs = u32("slabs along z, of as many layers as the kernel marches")
    own = f32("of the state itself, added; by steps over rows alone")


def step_rows(
    sigma_s: Sequence[float],
    sigma_t: Sequence[float],
    cell_size_m: float,
    *,
    level: int = 0,
    keeps_deficits: bool | None = None,
    kept: float = RHO**2,
) -> list[dict[str, Any]]:
    """Rows of StepCoefficients: M of channels 0, 1, 2, then T of the same.

    `sigma_s`, `sigma_t` (3,) m^-1. On a coarse `level` light is deposited where the finer walk
    would have, and walls do not keep deficits (`keeps_deficits`, by default on level 0 alone): a
    correction has either sign. `kept` is maths.lattice26.persistence of the finest lattice.
    """
    least = float(level == 0 if keeps_deficits is None else keeps_deficits)
    moves, tracks = [], []
    for s, t in zip(sigma_s, sigma_t, strict=True):
        move, track = _channel_rows(float(s), float(t), cell_size_m, level, least, kept / RHO)
        moves.append(move)
        tracks.append(track)
    return moves + tracks


def _channel_rows(
    sigma_s: float, sigma_t: float, cell_size_m: float, level: int, least: float, straight: float
) -> tuple[dict[str, Any], dict[str, Any]]:
    table = hops()
    w, cells = table.weights[list(_FIRST)], table.lengths[list(_FIRST)]
    length_m = cell_size_m * cells
    x = sigma_t * length_m
    p, half = np.exp(-x), np.exp(-0.5 * x)
    m = coarse_absorption_depth(x, level)
    t = length_m * mean_transmittance(x)
    t_half = 0.5 * length_m * mean_transmittance(0.5 * x)
    nothing, one = np.zeros(3), [1.0, 1.0, 1.0, 1.0]
    move = {
        "gain": one,
        "even": _four(w * (p + sigma_s * t * m), sigma_s * _COUNTS @ (w * t * (1.0 - m))),
        "direct": _four(3.0 * straight * w * p / cells, 0.0),
        "kept_even": _four(sigma_s * w * t * (1.0 - m), least),
        "kept_direct": _four(nothing, 0.0),
        "stopped_even": _four(sigma_s * w * t_half, 0.0),
        "stopped_direct": _four(nothing, 0.0),
        "returned_even": _four(w * half * (sigma_s * t_half + half), 0.0),
        "returned_direct": _four(returned_sharpness() * w * half**2, 0.0),
    }
    kept = _COUNTS @ (w * t * (1.0 - m))
    track = {
        "gain": one,
        "even": _four(w * t * m, kept),
        "direct": _four(RHO * w * t * m / cells, RHO**2 / 3.0 * kept),
        "kept_even": _four(w * t * (1.0 - m), least),
        "kept_direct": _four(RHO * w * t * (1.0 - m) / cells, 0.0),
        "stopped_even": _four(w * t_half, 0.0),
        "stopped_direct": _four(RHO * w * t_half / cells, 0.0),
        "returned_even": _four(w * half * t_half, 0.0),
        "returned_direct": _four(REFLECTED_TRACK * w * half * t_half, 0.0),
    }
    return move, track


def paper_rows(
    sigma_s: Sequence[float],
    sigma_t: Sequence[float],
    cell_size_m: float,
    *,
    is_gamma_fixed: bool = False,
) -> list[dict[str, Any]]:
    """Rows of StepCoefficients as Billeter2012 eq. 3 has them: M of three channels, then T.

    differs: with `is_gamma_fixed` the gamma_j hand on all that scatters; as printed, 0.70 of it.
    Raises SettingsError where lambda = d sigma_t >= 1, beyond which eq. 3 is unstable.
    """
    distance_m = mean_hop_length() * cell_size_m
    depth = distance_m * max(sigma_t)
    if depth >= 1.0:
        raise SettingsError(
            f"scheme = 'paper' needs less than 1 mean free path per hop, here are {depth:.3g}",
            remedy="Raise the resolution, thin the medium or use scheme = 'deposit'.",
        )
    table = hops()
    w, cells = table.weights[list(_FIRST)], table.lengths[list(_FIRST)]
    # gamma_j <Gamma_j|1> summed over the neighbours.
    printed = float(np.sqrt(4.0 * np.pi) / np.sqrt(table.weights).sum())
    handed_on = 1.0 if is_gamma_fixed else printed
    nothing = {name: [0.0] * 4 for name in StepCoefficients.fields}
    moves, tracks = [], []
    for s, t in zip(sigma_s, sigma_t, strict=True):
        passed = 1.0 - distance_m * t
        gain = [passed + handed_on * distance_m * s, passed, passed, passed]
        moves.append(
            nothing
            | {"gain": gain, "even": _four(w, 0.0), "direct": _four(3.0 * RHO * w / cells, 0.0)}
        )
        tracks.append(_local_track(nothing, distance_m, w))
    return moves + tracks


def _local_track(nothing: dict[str, Any], distance_m: float, w: F64) -> dict[str, Any]:
    """T of a step without places on the hop: its whole length counts in the cell it leaves.

    All own hops count, open (`kept`) or stopped.
    """
    even = _four(distance_m * w, 0.0)
    direct = _four(RHO * distance_m * w / hops().lengths[list(_FIRST)], 0.0)
    own = {
        "even": _four(np.zeros(3), distance_m),
        "direct": _four(np.zeros(3), RHO**2 / 3.0 * distance_m),
    }
    return (
        nothing
        | own
        | {
            "gain": [1.0] * 4,
            "kept_even": even,
            "kept_direct": direct,
            "stopped_even": even,
            "stopped_direct": direct,
        }
    )


def _four(three: F64, last: float | F64) -> list[float]:
    return [*np.asarray(three, dtype=np.float64).tolist(), float(last)]
