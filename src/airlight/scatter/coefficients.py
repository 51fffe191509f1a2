"""What a homogeneous medium does to one hop, as the numbers that the step's shader reads.

M takes the state on by one iteration, T gives the track length that it leaves behind; both are
linear and local, so one kernel serves both with other numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import SettingsError
from ..gpu.layout import Struct, vec3f, vec4f
from ..maths.lattice26 import RHO, flux_gain, hops, mean_hop_length
from ..maths.lattice26_walls import REFLECTED_TRACK, returned_sharpness
from ..maths.medium import mean_absorption_depth, mean_transmittance
from ..maths.transforms import F64

# Red, green and blue, each with a medium of its own.
CHANNELS = 3
_FIRST = (0, 6, 18)  # one hop of each kind


class StepCoefficients(Struct):
    """One channel's numbers; x, y, z are the three kinds of hop: face, edge, corner."""

    gain = vec4f("on what is read: A, Bx, By, Bz")
    arriving = vec3f("arriving power -> A")
    passing = vec3f("arriving power -> B, per offset, of what is not scattered on the way")
    kept = vec3f("own open hop -> own A")
    stopped = vec3f("own stopped hop -> own A, before it is reflected")
    returned = vec3f("own reflected hop -> own A")
    turned = vec3f("own reflected hop -> own B, per normal")


def step_rows(
    sigma_s: Sequence[float],
    sigma_t: Sequence[float],
    cell_size_m: float,
    *,
    persistence: float = RHO**2,
) -> list[dict[str, Any]]:
    """Rows of StepCoefficients: M of channels 0, 1, 2, then T of the same.

    `sigma_s`, `sigma_t` (3,) m^-1; `persistence` is maths.lattice26.persistence of the lattice.
    """
    # M moves light on, T adds up its track in the cell; both by channel.
    moves, tracks = [], []
    for s, t in zip(sigma_s, sigma_t, strict=True):
        move, track = _channel_rows(float(s), float(t), cell_size_m, persistence / RHO)
        moves.append(move)
        tracks.append(track)
    return moves + tracks


def _channel_rows(
    sigma_s: float, sigma_t: float, cell_size_m: float, straight: float
) -> tuple[dict[str, Any], dict[str, Any]]:
    table = hops()
    # One hop of each kind stands for all of its kind.
    w, cells = table.weights[list(_FIRST)], table.lengths[list(_FIRST)]
    length_m = cell_size_m * cells
    # Of a hop and of half of it: optical depth, transmittance, track; m: how far along it is lost.
    x = sigma_t * length_m
    p, half = np.exp(-x), np.exp(-0.5 * x)
    m = mean_absorption_depth(x)
    t = length_m * mean_transmittance(x)
    t_half = 0.5 * length_m * mean_transmittance(0.5 * x)
    ahead = float(flux_gain(sigma_s, sigma_t, cell_size_m, straight * RHO)) ** 2
    one = [1.0] * 4
    # The next state: what passes a hop, what the medium scatters on it, what walls give back.
    move = {
        "gain": one,
        "arriving": w * (p + sigma_s * t * m),
        "passing": 3.0 * straight * ahead * w * p / cells,
        "kept": sigma_s * w * t * (1.0 - m),
        "stopped": sigma_s * w * t_half,
        "returned": w * half * (sigma_s * t_half + half),
        "turned": returned_sharpness() * w * half**2,
    }
    # The track: how far the light comes in either cell before it is lost.
    track = {
        "gain": one,
        "arriving": w * t * m,
        "passing": np.zeros(3),
        "kept": w * t * (1.0 - m),
        "stopped": w * t_half,
        "returned": w * half * t_half,
        "turned": REFLECTED_TRACK * w * half * t_half,
    }
    return move, track


def handed_on(*, is_gamma_fixed: bool = False) -> float:
    """The share of what scatters that eq. 3 hands on: gamma_j <Gamma_j|1> over all neighbours.

    As printed 0.70; all of it with `is_gamma_fixed`.
    """
    return 1.0 if is_gamma_fixed else float(np.sqrt(4.0 * np.pi) / np.sqrt(hops().weights).sum())


def paper_gain(sigma_s: float, sigma_t: float, cell_size_m: float, share: float) -> F64:
    """What eq. 3 leaves of a state (A, B) in a cell, (4,): it scatters `share` of sigma_s."""
    # Eq. 3: 1 - d sigma_t of the state stays, and what is scattered comes on top of A.
    distance_m = mean_hop_length() * cell_size_m
    passed = 1.0 - distance_m * sigma_t
    return np.array([passed + share * distance_m * sigma_s, passed, passed, passed])


def check_depth(sigma_t: Sequence[float], cell_size_m: float) -> None:
    """Raise SettingsError where lambda = d sigma_t >= 1, beyond which eq. 3 is unstable."""
    # In mean free paths of the channel that is attenuated most.
    depth = mean_hop_length() * cell_size_m * max(sigma_t)
    if depth >= 1.0:
        raise SettingsError(
            f"scheme = 'paper' needs less than 1 mean free path per hop, here are {depth:.3g}",
            remedy="Raise the resolution, thin the medium or use scheme = 'deposit'.",
        )


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
    check_depth(sigma_t, cell_size_m)
    # One hop stands for all of its kind: through a face, an edge, a corner.
    distance_m = mean_hop_length() * cell_size_m
    table = hops()
    w, cells = table.weights[list(_FIRST)], table.lengths[list(_FIRST)]
    share = handed_on(is_gamma_fixed=is_gamma_fixed)
    # Eq. 3 deposits all in the cell that light enters, and no walls give anything back.
    nothing: dict[str, Any] = {name: np.zeros(3) for name in StepCoefficients.fields}
    moves, tracks = [], []
    for s, t in zip(sigma_s, sigma_t, strict=True):
        # A cell's state is taken times the gain, then handed to all neighbours by their weights.
        gain = paper_gain(s, t, cell_size_m, share).tolist()
        moves.append(nothing | {"gain": gain, "arriving": w, "passing": 3.0 * RHO * w / cells})
        # The whole length of a hop counts in the cell that it leaves, open or stopped.
        own = {"kept": distance_m * w, "stopped": distance_m * w}
        tracks.append(nothing | {"gain": [1.0] * 4} | own)
    return moves + tracks
