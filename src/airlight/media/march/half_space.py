"""Endless air beyond the lattice: there its light depends on the height alone (maths.plane_air).

A table over the depth below the air's top holds what suns and the sky bring (lamps are left out):
light of similar even air (scatter.reduced), the sky's light, and over the direction what air
scatters of that. Marching reads it where no lattice is: endless air has no border to be seen.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...fields import HalfSpaceLight
from ...gpu.device import Gpu
from ...gpu.memory import Buffer
from ...gpu.slots import Slot, storage
from ...maths.octahedron import octahedron_decode
from ...maths.phase import henyey_greenstein
from ...maths.plane_air import plane_light
from ...maths.transforms import F64
from ...scene.lights import DirectionalLight, Light
from ...scene.medium import Medium

ROWS = 64
SIDE = 17
"""Directions along each side of an octahedron's square, those on its borders among them."""
_LAST = 0.975  # of depth/(1 + depth), which rows are even in: 39 optical depths


class HalfSpace:
    """The table of one scene's endless air."""

    def __init__(self, gpu: Gpu) -> None:
        self._table = Buffer(gpu, "far air", ROWS * (2 + SIDE**2) * 16)
        self._key: object = None
        self._sky: tuple[object, F64] = (None, np.zeros(0))
        self._source = HalfSpaceLight(self._table, 1, 0.0, 1.0)

    def update(
        self,
        medium: Medium,
        top: float,
        lights: Sequence[Light],
        sky: Sequence[Light],
        *,
        is_lattice: bool,
    ) -> HalfSpaceLight:
        """What is marched of it; `is_lattice`: whether light scattered more than once, too."""
        key = (medium, top, tuple(lights), tuple(sky), is_lattice)
        if key != self._key:
            self._key = key
            if (of := (medium, tuple(sky))) != self._sky[0]:
                self._sky = (of, sky_once(medium, sky))
            rows = np.zeros((ROWS, 2 + side(medium) ** 2, 3))
            if is_lattice:
                rows[:, 0] = held(medium, lights, sky)
            rows[:, 1] = fluence(medium, sky, kept=False) / (4.0 * np.pi)
            rows[:, 2:] = self._sky[1]
            self._table.write(np.pad(rows, ((0, 0), (0, 0), (0, 1))).astype(np.float32))
            self._source = HalfSpaceLight(self._table, side(medium), top, max(medium.sigma_t))
        return self._source


def suns(lights: Sequence[Light], channel: int) -> tuple[F64, F64]:
    """(directions (B, 3), irradiances (B,)) of the directional ones."""
    parallel = [light for light in lights if isinstance(light, DirectionalLight)]
    ways = np.array([light.direction for light in parallel], np.float64).reshape(-1, 3)
    return ways, np.array([light.irradiance[channel] for light in parallel], np.float64)


def side(medium: Medium) -> int:
    """Directions along each side of the table's squares: one where all are alike."""
    return SIDE if any(medium.g) else 1


def travels(medium: Medium) -> F64:
    """(side^2, 3): unit, where light goes."""
    if side(medium) == 1:
        return np.array([[0.0, 1.0, 0.0]])
    t = np.linspace(-1.0, 1.0, SIDE)
    u, v = np.meshgrid(t, t)
    return octahedron_decode(np.stack([u, v], axis=-1)).reshape(-1, 3)


def _metres(medium: Medium) -> F64:
    """(ROWS,), below the top."""
    share = np.linspace(0.0, _LAST, ROWS)
    return share / (1.0 - share) / max(*medium.sigma_t, 1e-30)


def _from_above(lights: Sequence[Light], channel: int) -> tuple[F64, F64]:
    ways, irradiances = suns(lights, channel)
    is_down = ways[:, 1] < -1e-3
    return ways[is_down], irradiances[is_down]


def sky_once(medium: Medium, sky: Sequence[Light]) -> F64:
    """(ROWS, side^2, 3): what the lights of a `sky`, each a part of it, scatter first."""
    metres, out = _metres(medium), travels(medium)
    made = np.zeros((ROWS, len(out), 3))
    # Of a part of the sky, not of a point: to first order its mean cosine goes with g.
    whole = 1.0 - 1.0 / max(len(sky), 1)
    for c in range(3):
        ways, irradiances = _from_above(sky, c)
        arriving = np.exp(medium.sigma_t[c] * metres[:, None] / ways[:, 1]) * irradiances
        made[..., c] = arriving @ henyey_greenstein(ways @ out.T, whole * medium.g[c])
    return made


def fluence(medium: Medium, lights: Sequence[Light], *, kept: bool) -> F64:
    """(ROWS, 3), W m^-2: of `lights` on their straight way, through similar air where `kept`."""
    metres, made = _metres(medium), np.zeros((ROWS, 3))
    for c in range(3):
        ways, irradiances = _from_above(lights, c)
        sigma = medium.sigma_t[c] * (1.0 - kept * medium.albedo[c] * medium.g[c])
        made[:, c] = np.exp(sigma * metres[:, None] / ways[:, 1]) @ irradiances
    return made


def held(medium: Medium, lights: Sequence[Light], sky: Sequence[Light]) -> F64:
    """(ROWS, 3): mean radiance of what similar air scattered, and of the sky's light that came on
    through it only, as scatter's lattice has both.
    """
    metres, made = _metres(medium), np.zeros((ROWS, 3))
    for c in range(3):
        g = medium.g[c]
        kept = 1.0 - medium.albedo[c] * g
        ways, irradiances = suns([*lights, *sky], c)
        light = plane_light(medium.albedo[c] * (1.0 - g) / kept, -ways[:, 1], irradiances)
        made[:, c] = np.interp(medium.sigma_t[c] * kept * metres, light.depth, light.scattered)
    made += fluence(medium, sky, kept=True) - fluence(medium, sky, kept=False)
    return made / (4.0 * np.pi)


def far_slots() -> tuple[Slot, ...]:
    """What marching binds."""
    return (storage("far_light", "vec4f"),)


_EMISSION_WGSL = f"""
//! use octahedron
// The share of a place that no lattice holds.
fn lattice_left() -> f32 {{
    var left = 1.0;
    for (var i = 0u; i < LATTICES_AT_ONCE; i++) {{ left -= lattice_at[i].w; }}
    return saturate(left);
}}

fn forward_share() -> f32 {{ return 1.0 - lattice_left(); }}

// The row of a depth, and how far on to the next.
fn far_row(p: vec3f) -> vec2f {{
    let depth = own.far_sigma * max(own.far_top - p.y, 0.0);
    let row = min(depth / (1.0 + depth) / {_LAST}, 1.0) * {ROWS - 1}.0;
    let i = min(floor(row), {ROWS - 2}.0);
    return vec2f(i, row - i);
}}

const FAR_ROW = 2u + FAR_SIDE * FAR_SIDE;

fn far_mean(column: u32, row: vec2f) -> vec3f {{
    let first = u32(row.x) * FAR_ROW + column;
    return mix(far_light[first].rgb, far_light[first + FAR_ROW].rgb, row.y);
}}

// Towards a place of the octahedron's square, in texels.
fn far_towards(row: vec2f, at: vec2f) -> vec3f {{
    if (FAR_SIDE == 1u) {{ return far_mean(2u, row); }}
    let low = min(vec2u(at), vec2u(FAR_SIDE - 2u));
    let f = at - vec2f(low);
    let first = 2u + low.y * FAR_SIDE + low.x;
    return mix(mix(far_mean(first, row), far_mean(first + 1u, row), f.x),
        mix(far_mean(first + FAR_SIDE, row), far_mean(first + FAR_SIDE + 1u, row), f.x), f.y);
}}

// Of the scene's own air, which is the first of all media.
fn far_emission(p: vec3f, travel: vec3f) -> vec3f {{
    let light = media_reduced_sigma_s[0] * far_mean(0u, far_row(p)) + far_forward(p, travel);
    return lattice_left() * media_density_here[0] * light;
}}

var<private> far_sky: vec3f;
fn far_sky_even() -> vec3f {{ return far_sky; }}

fn far_skylit(p: vec3f, travel: vec3f) -> vec3f {{
    let row = far_row(p);
    let at = (0.5 * octahedron_encode(travel) + 0.5) * f32(FAR_SIDE - 1u);
    let here = lattice_left() * media_density_here[0];
    far_sky = here * media_reduced_sigma_s[0] * far_mean(1u, row);
    return here * media_lit_scattering[0] * far_towards(row, at);
}}
"""
_FORWARD_WGSL = """
// What suns bring through similar air (scatter/forward.wgsl).
fn far_forward(p: vec3f, travel: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < own.forward_count; i++) {
        let light = forward_table[i];
        if (light.kind != LIGHT_DIRECTIONAL || light.direction.y > -1e-3) { continue; }
        let way = max(own.far_top - p.y, 0.0) / -light.direction.y;
        let depth = dot(media_lit_scattering[0], vec3f(1.0 / 3.0)) * way;
        sum += light.color * exp(-media_reduced_sigma_t[0] * way)
            * fused_phase(0u, dot(light.direction, travel), depth + eye_depth);
    }
    return media_lit_scattering[0] * sum;
}
"""
_NO_FORWARD_WGSL = "fn far_forward(p: vec3f, travel: vec3f) -> vec3f { return vec3f(0.0); }\n"
_STEPS_WGSL = """
// Where the ray is in the largest lattice; steps beyond it are a share of an optical depth.
fn held_span(origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f {
    let last = lattices[arrayLength(&lattices) - 1u];
    let span = ray_box_interval(origin, direction, last.fade_low, last.fade_high);
    let held = clamp(span, vec2f(hull.x), vec2f(hull.y));
    return select(vec2f(hull.y), held, held.x < held.y);
}

fn held_step(t: f32, held: vec2f, near: f32) -> f32 {
    let far = 0.25 / own.far_sigma;
    let before = min(far, max(held.x - t, 1e-4));
    let inside = select(max(near, far), min(near, max(held.y - t, 1e-4)), t < held.y);
    return select(inside, before, t < held.x);
}
"""


def far_wgsl(size: int, *, has_forward: bool) -> str:
    """What marching reads of a table of `size`^2 directions; suns' forward light, or none."""
    beams = _FORWARD_WGSL if has_forward else _NO_FORWARD_WGSL
    return f"const FAR_SIDE = {size}u;\n{_EMISSION_WGSL}{beams}{_STEPS_WGSL}"


NO_FAR_WGSL = """
fn forward_share() -> f32 { return 1.0; }
fn held_span(origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f { return hull; }
fn held_step(t: f32, held: vec2f, near: f32) -> f32 { return near; }
"""
