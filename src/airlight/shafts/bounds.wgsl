//! use depth_bounds

// Squares beyond the map's edge bound nothing.
fn child(layer: u32, square: vec2u) -> vec2f {
    if (params.level > 1u) {
        return bounds[bounds_index(params.side, layer, params.level - 1u, square)];
    }
    if (any(square >= vec2u(params.resolution))) {
        return vec2f(NEVER, -NEVER);
    }
    return vec2f(shadow_depth(textureLoad(depth, vec2i(square), layer, 0)));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let squares = params.side >> params.level;
    if (any(id.xy >= vec2u(squares)) || id.z >= params.layers) {
        return;
    }
    let first = 2u * id.xy;
    let a = child(id.z, first);
    let b = child(id.z, first + vec2u(1u, 0u));
    let c = child(id.z, first + vec2u(0u, 1u));
    let d = child(id.z, first + 1u);
    let low = min(min(a.x, b.x), min(c.x, d.x));
    let high = max(max(a.y, b.y), max(c.y, d.y));
    bounds[bounds_index(params.side, id.z, params.level, id.xy)] = vec2f(low, high);
}
