"""Light that went through similar air, light by light, for marching.

Two bands cannot hold what a strong g makes of it; a texture holds how much of each light arrives so
in each cell of a lattice, and how deep in scattering it is, and marching asks fused_phase.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...fields import FORWARD_BLOCK
from ...gpu.slots import Slot, storage, texture
from ...maths.forward_phase import fused_table
from ...scene.checks import F32
from ...surface.light_table import LightData


def forward_slots() -> tuple[Slot, ...]:
    """What marching binds."""
    return (
        storage("forward_table", LightData),
        texture("forward_lights", "3d"),
        texture("forward_blurred", "3d"),
        storage("fused", "vec4f"),
    )


def fused_rows(rows: Sequence[dict[str, Any]]) -> F32:
    """(media * 2 * DEPTHS * COSINES, 4): the tables of `fused` for the rows of GpuMedia."""
    known: dict[float, Any] = {}
    tables = []
    for g in (row["g"] for row in rows):
        three = [known.setdefault(c, fused_table(c)) for c in map(float, g)]
        tables.append(np.stack([*three, np.zeros_like(three[0])], axis=-1).reshape(-1, 4))
    return np.concatenate(tables).astype(np.float32)


FORWARD_WGSL = f"""
//! use lights
//! use fused_phase
// Of a step that similar air lets `evenly` m of light through to, the air itself `reached`. What is
// scattered on on its way to the eye is blurred by it, .29 sqrt(2 (1 - g)) of the way.
fn forward_light(p: vec3f, travel: vec3f, reached: vec3f, evenly: vec3f) -> ForwardLight {{
    var sum = ForwardLight(vec3f(0.0), vec3f(0.0));
    if (lattice_at[0].w <= 0.0) {{ return sum; }}
    let blocks = vec3f(textureDimensions(forward_blurred)) / vec3f(1.0, 1.0, own.forward_slabs);
    let cells = vec3f(textureDimensions(forward_lights)) / vec3f(1.0, 1.0, own.forward_slabs);
    let place = clamp(lattice_at[0].xyz * cells / {FORWARD_BLOCK}.0, vec3f(0.5), blocks - 0.5);
    for (var i = 0u; i < own.forward_count; i++) {{
        let uvw = vec3f(lattice_at[0].xy, (lattice_at[0].z + f32(i)) / own.forward_slabs);
        let light = textureSampleLevel(forward_lights, linear_clamp, uvw, 0.0);
        let around = vec3f(place.xy, place.z + f32(i) * blocks.z)
            / vec3f(textureDimensions(forward_blurred));
        let wide = textureSampleLevel(forward_blurred, linear_clamp, around, 0.0).rgb;
        if (all(light.rgb + wide <= vec3f(0.0))) {{ continue; }}
        var way = forward_table[i].direction;
        if (forward_table[i].kind != LIGHT_DIRECTIONAL) {{
            way = normalize(p - forward_table[i].position);
        }}
        let mu = dot(way, travel);
        for (var m = 0u; m < MEDIA_COUNT; m++) {{
            let before = fused_phase(m, mu, light.a) * reached;
            let all = fused_phase(m, mu, light.a + eye_depth) * evenly;
            let far = saturate(own.forward_spread * (1.0 - media[m].g.g) * eye_way * eye_way);
            let shines = media_density_here[m] * media_lit_scattering[m];
            sum.last += shines * light.rgb * last_phase(m, mu, light.a) * reached;
            sum.on += shines
                * (light.rgb * before + mix(light.rgb, wide, far) * max(all - before, vec3f(0.0)));
        }}
    }}
    let scale = own.forward_scale * forward_share();
    return ForwardLight(scale * sum.last, scale * sum.on);
}}
"""
