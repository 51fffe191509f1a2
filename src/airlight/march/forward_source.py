"""Light that was scattered forwards only, light by light, for marching.

Two bands cannot hold what a strong g makes of it; a texture holds how much of each light arrives so
in each cell of a lattice, and how far it has come, and marching asks the phase function.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..gpu.memory import Buffer, Texture
from ..gpu.slots import Slot, storage, texture
from ..surface.light_table import LightData


@dataclass(frozen=True, eq=False)
class ForwardSource:
    """rgb W m^-2 times 1/`scale`, a: depth of forward scattering; `slabs` lights along z.

    `table`: their rows of LightData, of which the first `count` shine.
    """

    texture: Texture
    table: Buffer
    count: int
    slabs: int
    scale: float


def forward_slots() -> tuple[Slot, ...]:
    """What marching binds."""
    return (storage("forward_table", LightData), texture("forward_lights", "3d"))


FORWARD_WGSL = """
//! use lights
//! use forward_phase
fn forward_emission(p: vec3f, travel: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    if (lattice_at[0].w <= 0.0) { return sum; }
    for (var i = 0u; i < own.forward_count; i++) {
        let uvw = vec3f(lattice_at[0].xy, (lattice_at[0].z + f32(i)) / own.forward_slabs);
        let light = textureSampleLevel(forward_lights, linear_clamp, uvw, 0.0);
        if (all(light.rgb <= vec3f(0.0))) { continue; }
        var way = forward_table[i].direction;
        if (forward_table[i].kind != LIGHT_DIRECTIONAL) {
            way = normalize(p - forward_table[i].position);
        }
        let mu = dot(way, travel);
        let n = forward_scatterings(light.a);
        for (var m = 0u; m < AIR_COUNT; m++) {
            let g = air[m].g;
            sum += light.rgb * air_here[m] * air_shines[m] * vec3f(forward_phase(mu, g.r, n),
                    forward_phase(mu, g.g, n), forward_phase(mu, g.b, n));
        }
    }
    return own.forward_scale * sum;
}
"""
