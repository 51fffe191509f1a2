// The solved track as textures for marching: a channel each, and the constant terms of all three.
//! use cell_order
//! use half_range

// (V_a, 3 V_b) as half floats hold them.
fn stored(index: u32, share: f32) -> vec4f {
    var v = share * track[index];
    if (params.has_forward != 0u) {
        v += forward[index];
    }
    // A two-band state may dip below zero beside a strong source; light does not.
    let power = max(v.x, 0.0);
    return within_half_range(vec4f(power, 3.0 * v.yzw) * params.scale);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cells = params.count.x * params.count.y * params.count.z;
    let cell = cell_in(params.count, id);
    // The three channels, and for media that ask for no direction their constant terms alone.
    let r = stored(cell, params.share.r);
    let g = stored(cell + cells, params.share.g);
    let b = stored(cell + 2u * cells, params.share.b);
    let texel = id + vec3u(0u, params.first_row, 0u);
    textureStore(red, texel, r);
    textureStore(green, texel, g);
    textureStore(blue, texel, b);
    textureStore(mean, texel, vec4f(r.x, g.x, b.x, 1.0));
}
