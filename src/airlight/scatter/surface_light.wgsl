// The sum of all states as textures that surfaces read.
//! use hops26
//! use cell_order
//! use half_range

override SCATTERED_GAIN: f32;

// The state by how much of it reaches walls, with the beams that the lattice does not hold.
fn stored(index: u32, weight: f32) -> vec4f {
    var state = total[index] * (weight * params.scale);
    if (params.forward > 0.0) {
        let beams = forward[index];
        state += params.forward * vec4f(beams.x, 3.0 * beams.yzw);
    }
    return within_half_range(state);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cells = params.count.x * params.count.y * params.count.z;
    let cell = cell_in(params.count, id);
    // The medium of the lattice, or of this cell.
    var sigma_s = params.sigma_s;
    var sigma_t = params.sigma_t;
    if (params.is_varied != 0u) {
        let r = medium[cell];
        let g = medium[cell + cells];
        let b = medium[cell + 2u * cells];
        sigma_s = vec3f(r.x, g.x, b.x);
        sigma_t = vec3f(r.y, g.y, b.y);
    }
    // Of the light that reaches a wall, this share comes from the medium.
    let scattered = 1.0 - exp(-sigma_s * params.chord);
    let weight = mean_track(sigma_t, params.cell) * (1.0 + SCATTERED_GAIN * scattered);
    let texel = id + vec3u(0u, params.first_row, 0u);
    textureStore(red, texel, stored(cell, weight.r));
    textureStore(green, texel, stored(cell + cells, weight.g));
    textureStore(blue, texel, stored(cell + 2u * cells, weight.b));
}
