// One level of bounds from the finer one. Level 0 has been copied from the maps.
//! use shadow_levels

// Squares beyond the map's edge bound nothing.
fn texel_bounds(square: vec2u, depth: f32) -> vec2f {
    let bounds = vec2f(shadow_depth(depth));
    return select(bounds, vec2f(NEVER, -NEVER), any(square >= vec2u(params.resolution)));
}

fn together(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(min(a.x, b.x), max(a.y, b.y));
}

// Of two squares beside each other: one entry holds two texels, larger ones have their own.
fn pair(layer: u32, left: vec2u) -> vec2f {
    let entry = level_entry(params.side, layer, select(params.level - 1u, 0u, IS_FIRST), left);
    let first = bounds[entry];
    if (!IS_FIRST) {
        return together(first, bounds[entry + 1u]);
    }
    return together(texel_bounds(left, first.x), texel_bounds(left + vec2u(1u, 0u), first.y));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let level = params.level;
    let squares = params.side >> level;
    if (any(id.xy >= vec2u(squares)) || id.z >= params.layers) {
        return;
    }
    let first = 2u * id.xy;
    bounds[level_entry(params.side, id.z, level, id.xy)] =
        together(pair(id.z, first), pair(id.z, first + vec2u(0u, 1u)));
}
