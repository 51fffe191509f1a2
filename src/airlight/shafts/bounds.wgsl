// One level of bounds from the finer one, two squares beside each other at once: software drivers pay
// for reads, whatever they bring. Level 0 has been copied from the maps.
//! use shadow_levels

// Squares beyond the map's edge bound nothing.
fn texel_bounds(square: vec2u, depth: f32) -> vec2f {
    let bounds = vec2f(shadow_depth(depth));
    return select(bounds, vec2f(NEVER, -NEVER), any(square >= vec2u(params.resolution)));
}

fn together(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(min(a.x, b.x), max(a.y, b.y));
}

// Of a texel and the next one of its row.
fn of_texels(left: vec2u, depths: vec2f) -> vec2f {
    return together(texel_bounds(left, depths.x), texel_bounds(left + vec2u(1u, 0u), depths.y));
}

// Of four squares of the finer level in a row: the first two, and the others.
fn pairs(layer: u32, left: vec2u) -> vec4f {
    let entry = level_entry(params.side, layer, select(params.level - 1u, 0u, IS_FIRST), left) / 2u;
    let first = bounds[entry];
    if (IS_FIRST) {
        return vec4f(of_texels(left, first.xy), of_texels(left + vec2u(2u, 0u), first.zw));
    }
    let second = bounds[entry + 1u];
    return vec4f(together(first.xy, first.zw), together(second.xy, second.zw));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let squares = params.side >> params.level;
    let square = vec2u(2u * id.x, id.y);
    if (any(square >= vec2u(squares)) || id.z >= params.layers) {
        return;
    }
    let a = pairs(id.z, 2u * square);
    let b = pairs(id.z, 2u * square + vec2u(0u, 1u));
    let both = vec4f(together(a.xy, b.xy), together(a.zw, b.zw));
    let entry = level_entry(params.side, id.z, params.level, square);
    // The one square of the last level lies second.
    bounds[entry / 2u] = select(both, both.zwxy, squares == 1u);
}
