"""An analytic half-space medium beyond the lattices: its light depends on the height alone.

A table over the depth below the top of an endless medium holds the light of directional lights and
the sky (local lights are left out): multiple scattering of the reduced medium (`media.reduced`),
the light of the sky, and by direction what the medium scatters of that. Marching reads it where no
lattice is, so that an endless medium has no visible border. See `maths.half_space`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...fields import HalfSpaceLight
from ...gpu.device import Gpu
from ...gpu.memory import Buffer
from ...gpu.slots import Slot, storage
from ...maths.half_space import plane_light
from ...maths.octahedron import octahedron_decode
from ...maths.phase import scattering_phase
from ...maths.transforms import F64
from ...scene.lights import DirectionalLight, Light
from ...scene.medium import Medium

# Depths below the medium's top that the table has.
ROWS = 64
SIDE = 17
"""Directions along each side of the square of an octahedron, those on its borders included."""
_LAST = 0.975  # of depth/(1 + depth), in which rows are equally spaced: 39 optical depths


class HalfSpace:
    """The table of the endless medium of one scene."""

    def __init__(self, gpu: Gpu) -> None:
        # A row for each depth: two means, then radiance by direction.
        self._table = Buffer(gpu, "half space", ROWS * (2 + SIDE**2) * 16)
        self._key: object = None
        # The sky's part is kept apart: it stays as it is while other lights change.
        self._sky: tuple[object, F64] = (None, np.zeros(0))
        self._light = HalfSpaceLight(self._table, 1, 0.0, 1.0)

    def update(
        self,
        medium: Medium,
        top: float,
        lights: Sequence[Light],
        sky: Sequence[Light],
        *,
        is_lattice: bool,
    ) -> HalfSpaceLight:
        """The light to march; `is_lattice`: lattices hold multiple scattering, so it does, too."""
        key = (medium, top, tuple(lights), tuple(sky), is_lattice)
        if key != self._key:
            self._key = key
            # The sky's light by direction does not depend on the scene's lights.
            if (lit := (medium, tuple(sky))) != self._sky[0]:
                self._sky = (lit, sky_single_scatter(medium, sky))
            # A row: mean radiance of the reduced medium, that of the sky, then directions.
            rows = np.zeros((ROWS, 2 + side(medium) ** 2, 3))
            if is_lattice:
                rows[:, 0] = reduced_radiance(medium, lights, sky)
            rows[:, 1] = fluence(medium, sky, is_reduced=False) / (4.0 * np.pi)
            rows[:, 2:] = self._sky[1]
            self._table.write(np.pad(rows, ((0, 0), (0, 0), (0, 1))).astype(np.float32))
            self._light = HalfSpaceLight(self._table, side(medium), top, max(medium.sigma_t))
        return self._light


def directional(lights: Sequence[Light], channel: int) -> tuple[F64, F64]:
    """(directions (B, 3), irradiances (B,)) of the directional ones among `lights`."""
    found = [light for light in lights if isinstance(light, DirectionalLight)]
    directions = np.array([light.direction for light in found], np.float64).reshape(-1, 3)
    return directions, np.array([light.irradiance[channel] for light in found], np.float64)


def side(medium: Medium) -> int:
    """Directions along each side of the table's squares: one for an isotropic phase function."""
    return SIDE if any(medium.g) else 1


def travels(medium: Medium) -> F64:
    """(side^2, 3): the unit directions of travel of the table."""
    # An isotropic phase function needs one direction, whichever.
    if side(medium) == 1:
        return np.array([[0.0, 1.0, 0.0]])
    t = np.linspace(-1.0, 1.0, SIDE)
    u, v = np.meshgrid(t, t)
    return octahedron_decode(np.stack([u, v], axis=-1)).reshape(-1, 3)


def _metres(medium: Medium) -> F64:
    """(ROWS,): the distance of each row below the top."""
    # Rows are closest at the top, where light changes most.
    share = np.linspace(0.0, _LAST, ROWS)
    return share / (1.0 - share) / max(*medium.sigma_t, 1e-30)


def _from_above(lights: Sequence[Light], channel: int) -> tuple[F64, F64]:
    """The directional lights that reach a half space."""
    # Light from below or along the top never enters.
    directions, irradiances = directional(lights, channel)
    is_down = directions[:, 1] < -1e-3
    return directions[is_down], irradiances[is_down]


def sky_single_scatter(medium: Medium, sky: Sequence[Light]) -> F64:
    """(ROWS, side^2, 3): single scattering of a `sky`, each light of which is a part of it."""
    # Attenuated from the top down to each row, then scattered once.
    metres, out = _metres(medium), travels(medium)
    made = np.zeros((ROWS, len(out), 3))
    # The mean cosine of a part of the sky multiplies g, to first order.
    cosine = 1.0 - 1.0 / max(len(sky), 1)
    for c in range(3):
        directions, irradiances = _from_above(sky, c)
        depth = medium.sigma_t[c] * metres[:, None] / directions[:, 1]
        arriving = np.exp(depth) * irradiances
        made[..., c] = arriving @ scattering_phase(directions @ out.T, cosine * medium.g[c])
    return made


def fluence(medium: Medium, lights: Sequence[Light], *, is_reduced: bool) -> F64:
    """(ROWS, 3), W m^-2: unscattered light, attenuated by the medium or by the reduced one."""
    # Beer-Lambert down to each row, along slanted paths.
    metres, made = _metres(medium), np.zeros((ROWS, 3))
    for c in range(3):
        directions, irradiances = _from_above(lights, c)
        sigma = medium.sigma_t[c] * (1.0 - is_reduced * medium.albedo[c] * medium.g[c])
        made[:, c] = np.exp(sigma * metres[:, None] / directions[:, 1]) @ irradiances
    return made


def reduced_radiance(medium: Medium, lights: Sequence[Light], sky: Sequence[Light]) -> F64:
    """(ROWS, 3): the mean radiance that the reduced medium scatters.

    The sky's light that only the reduced medium transmits is added, as in the lattice of `scatter`.
    """
    metres, made = _metres(medium), np.zeros((ROWS, 3))
    for c in range(3):
        # Similarity theory: sigma_s (1 - g) and sigma_a stay.
        g = medium.g[c]
        reduced = 1.0 - medium.albedo[c] * g
        directions, irradiances = directional([*lights, *sky], c)
        light = plane_light(medium.albedo[c] * (1.0 - g) / reduced, -directions[:, 1], irradiances)
        made[:, c] = np.interp(medium.sigma_t[c] * reduced * metres, light.depth, light.scattered)
    made += fluence(medium, sky, is_reduced=True) - fluence(medium, sky, is_reduced=False)
    return made / (4.0 * np.pi)


def half_space_slots() -> tuple[Slot, ...]:
    """What marching binds."""
    return (storage("half_space", "vec4f"),)


def half_space_wgsl(size: int, *, has_forward: bool) -> str:
    """WGSL of marching a table of `size`^2 directions; `has_forward`: with forward light."""
    forward = "half_space_forward" if has_forward else "half_space_no_forward"
    return (
        f"const HALF_SPACE_SIDE = {size}u;\nconst HALF_SPACE_ROWS = {ROWS}u;\n"
        f"const HALF_SPACE_LAST = {_LAST};\n//! use half_space\n//! use {forward}\n"
    )


NO_HALF_SPACE_WGSL = "//! use no_half_space\n"
