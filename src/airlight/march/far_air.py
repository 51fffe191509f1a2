"""Endless air beyond the lattice: there its light depends on the height alone (maths.plane_air).

A table over the depth below the air's top holds what suns and the sky bring (lamps are left out):
the sky's light scattered once, and all light scattered more often. Marching reads it where no
lattice is, so that endless air has no border to be seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..gpu.device import Gpu
from ..gpu.memory import Buffer
from ..gpu.slots import Slot, storage
from ..maths.plane_air import PlaneLight, plane_light
from ..maths.transforms import F64
from ..scene.lights import DirectionalLight, Light
from ..scene.medium import Medium

ROWS = 64
_LAST = 0.975  # of depth/(1 + depth), which rows are even in: 39 optical depths
_MULTIPLE, _SKY = 0, 1


@dataclass(frozen=True, eq=False)
class FarSource:
    """`table`: rows of mean radiance and three times its flux over 4 pi, for each kind and channel.

    `top`, m, where the air begins; `sigma_t`, m^-1, of its densest channel.
    """

    table: Buffer
    top: float
    sigma_t: float


class FarAir:
    """The table of one scene's endless air."""

    def __init__(self, gpu: Gpu) -> None:
        self._table = Buffer(gpu, "far air", 2 * 3 * ROWS * 16)
        self._key: object = None
        self._source = FarSource(self._table, 0.0, 1.0)

    def update(
        self, medium: Medium, top: float, lights: Sequence[Light], sky: Sequence[Light], *,
        is_lattice: bool,
    ) -> FarSource:  # fmt: skip
        """What is marched of it; `is_lattice`: whether light scattered more than once, too."""
        key = (medium, top, tuple(lights), tuple(sky), is_lattice)
        if key != self._key:
            self._key = key
            depth = _depths()
            strongest = max(medium.sigma_t)
            metres = depth / max(strongest, 1e-30)
            rows = np.zeros((2, 3, ROWS, 4))
            for c in range(3):
                if is_lattice:
                    rows[_MULTIPLE, c] = _multiple(medium, [*lights, *sky], metres, c)
                rows[_SKY, c] = _beams(medium.sigma_t[c], sky, metres, c)
            self._table.write((rows / (4.0 * np.pi)).astype(np.float32))
            self._source = FarSource(self._table, top, strongest)
        return self._source

    def release(self) -> None:
        """Give the memory back."""
        self._table.release()


def suns(lights: Sequence[Light], channel: int) -> tuple[F64, F64]:
    """(directions (B, 3), irradiances (B,)) of the directional ones."""
    parallel = [light for light in lights if isinstance(light, DirectionalLight)]
    ways = np.array([light.direction for light in parallel], np.float64).reshape(-1, 3)
    return ways, np.array([light.irradiance[channel] for light in parallel], np.float64)


def scattered_light(medium: Medium, lights: Sequence[Light], channel: int) -> PlaneLight:
    """What `lights` bring into endless air, scattered at least once; its g as if it were 0."""
    ways, irradiances = suns(lights, channel)
    return plane_light(medium.albedo[channel], -ways[:, 1], irradiances)


def _depths() -> F64:
    share = np.linspace(0.0, _LAST, ROWS)
    return share / (1.0 - share)


def _beams(sigma_t: float, lights: Sequence[Light], metres: F64, channel: int) -> F64:
    """(ROWS, 4): fluence and three times the flux of light on its straight way."""
    ways, irradiances = suns(lights, channel)
    is_down = ways[:, 1] < -1e-3
    ways, irradiances = ways[is_down], irradiances[is_down]
    arriving = np.exp(sigma_t * metres[:, None] / ways[:, 1]) * irradiances
    return np.column_stack([arriving.sum(axis=1), 3.0 * arriving @ ways])


def _multiple(medium: Medium, lights: Sequence[Light], metres: F64, channel: int) -> F64:
    """(ROWS, 4): the same of scattered light; of what air that scatters forwards keeps near its
    beam (scatter.forward), too.
    """
    g = medium.g[channel]
    kept = 1.0 - medium.albedo[channel] * g
    similar = medium.albedo[channel] * (1.0 - g) / kept
    ways, irradiances = suns(lights, channel)
    light = plane_light(similar, -ways[:, 1], irradiances)
    sigma = medium.sigma_t[channel]
    depth = sigma * kept * metres
    rows = np.zeros((ROWS, 4))
    rows[:, 0] = np.interp(depth, light.depth, light.scattered)
    rows[:, 2] = -3.0 * np.interp(depth, light.depth, light.flux)
    if g != 0.0:
        rows += _beams(sigma * kept, lights, metres, channel)
        rows -= _beams(sigma, lights, metres, channel)
    return rows


def far_slots() -> tuple[Slot, ...]:
    """What marching binds."""
    return (storage("far_light", "vec4f"),)


FAR_WGSL = f"""
// The share of a place that no lattice holds.
fn lattice_left() -> f32 {{
    var left = 1.0;
    for (var i = 0u; i < LATTICES_AT_ONCE; i++) {{ left -= lattice_at[i].w; }}
    return saturate(left);
}}

fn far_state(row: f32, first: u32) -> vec4f {{
    let i = min(u32(row), {ROWS - 2}u);
    return mix(far_light[first + i], far_light[first + i + 1u], row - f32(i));
}}

// Of the scene's own air, which is the first of all media; kind 0 multiple, 1 the sky's, once.
fn far_emission(kind: u32, p: vec3f, travel: vec3f) -> vec3f {{
    let depth = own.far_sigma * max(own.far_top - p.y, 0.0);
    let row = min(depth / (1.0 + depth) / {_LAST}, 1.0) * {ROWS - 1}.0;
    let first = kind * {3 * ROWS}u;
    let g = air[0].g;
    return lattice_left() * air_here[0] * air_shines[0] * vec3f(
        lattice_radiance(far_state(row, first), travel, g.r),
        lattice_radiance(far_state(row, first + {ROWS}u), travel, g.g),
        lattice_radiance(far_state(row, first + {2 * ROWS}u), travel, g.b));
}}

// Where the ray is in the largest lattice; steps beyond it are a share of an optical depth.
fn held_span(origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f {{
    let last = lattices[arrayLength(&lattices) - 1u];
    let span = ray_box_interval(origin, direction, last.fade_low, last.fade_high);
    let held = clamp(span, vec2f(hull.x), vec2f(hull.y));
    return select(vec2f(hull.y), held, held.x < held.y);
}}

fn held_step(t: f32, held: vec2f, near: f32) -> f32 {{
    let far = 0.25 / own.far_sigma;
    let before = min(far, max(held.x - t, 1e-4));
    let inside = select(max(near, far), min(near, max(held.y - t, 1e-4)), t < held.y);
    return select(inside, before, t < held.x);
}}
"""
NO_FAR_WGSL = """
fn held_span(origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f { return hull; }
fn held_step(t: f32, held: vec2f, near: f32) -> f32 { return near; }
"""
