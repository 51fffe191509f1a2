// One level of bounds from the finer one, four squares of a row at once: CPU adapters pay for reads, whatever
// their size. Level 0 has been copied from the maps.
//! use shadow_levels

// Where the square with a texel is, of a layer and level; in fours.
fn at(texel: vec2u, layer: u32, level: u32) -> u32 {
    return level_entry(2u * layer * params.side * params.side, params.side, level, texel) / 4u;
}

// Of two squares each.
fn together(a: vec4u, b: vec4u) -> vec4u {
    return (max(a, b) & vec4u(FARTHEST_BITS))
        | min(a & vec4u(NEAREST_BITS), b & vec4u(NEAREST_BITS));
}

// Nearest and farthest of columns of two texels. Texels beyond the map's edge bound nothing.
fn of_columns(first: vec2u, upper: vec4u, lower: vec4u) -> array<vec4f, 2> {
    let is_beyond = first.x + vec4u(0u, 1u, 2u, 3u) >= vec4u(params.resolution);
    let is_above = is_beyond | vec4<bool>(first.y >= params.resolution);
    let is_below = is_beyond | vec4<bool>(first.y + 1u >= params.resolution);
    let a = bitcast<vec4f>(upper);
    let b = bitcast<vec4f>(lower);
    let one = vec4f(1.0);
    let none = vec4f(0.0);
    return array(min(select(a, one, is_above), select(b, one, is_below)),
        max(select(a, none, is_above), select(b, none, is_below)));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let squares = params.side >> params.level;
    let square = vec2u(4u * id.x, id.y);
    if (any(square >= vec2u(squares)) || id.z >= params.layers) {
        return;
    }
    // The two rows of finer squares below four squares of this level.
    let finer = select(params.level - 1u, 0u, IS_FIRST);
    let texel = square << vec2u(params.level);
    let upper = at(texel, id.z, finer);
    let lower = at(texel + vec2u(0u, 1u << finer), id.z, finer);
    let a = bounds[upper];
    let b = bounds[upper + 1u];
    let c = bounds[lower];
    let d = bounds[lower + 1u];
    // Of depths, or of bounds: the nearest and the farthest of each four.
    var made: vec4u;
    if (IS_FIRST) {
        let l = of_columns(texel, a, c);
        let r = of_columns(texel + vec2u(4u, 0u), b, d);
        made = packed_bounds(
            min(vec4f(l[0].xz, r[0].xz), vec4f(l[0].yw, r[0].yw)),
            max(vec4f(l[1].xz, r[1].xz), vec4f(l[1].yw, r[1].yw)));
    } else {
        let l = together(a, c);
        let r = together(b, d);
        made = together(vec4u(l.xz, r.xz), vec4u(l.yw, r.yw));
    }
    bounds[at(texel, id.z, params.level)] = made;
}
