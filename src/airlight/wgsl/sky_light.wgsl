// What a cell holds of a sky's light, as sums over the lights that stand for it. The including pass
// declares `params` with their `scale`.
//! use half_range

struct SkyLight {
    fluence: vec3f,     // W m^-2
    flux: mat3x3f,      // net, by axis
    squares: mat3x4f,   // of the third band, see third_band.wgsl
    rest: vec3f,
    plus: mat3x3f,      // irradiance on faces towards +x, +y, +z
    minus: mat3x3f,
}

fn stored(fluence: f32, flux: vec3f) -> vec4f {
    let v = params.scale * vec4f(fluence, flux);
    return within_half_range(v);
}
