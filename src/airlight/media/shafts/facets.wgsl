// One level of the tree: a plane through four squares, and how far it lies off them.
//! use facets

// Slopes beyond this, texels of depth per texel, are steps: a ramp would leak light.
const STEEPEST = 4.0;

// What one texel's side is in depth, at a depth.
fn texel_in_depth(layer: u32, depth: f32) -> f32 {
    let view = row_of_views(layer);
    let along = view.world_from_clip[2];
    if (view.is_perspective == 0u) {
        return view.texel.x / length(along.xyz);
    }
    let inverse_distance = view.world_from_clip[3].w + depth * along.w;
    return view.texel.x * inverse_distance / abs(along.w);
}

// The plane of a square: depth in its middle, slopes, how far it lies off; -1 where none fits.
fn fitted(layer: u32, node: vec2u) -> vec4f {
    let below = tree.level - 1u;
    let a = facet_plane(layer, below, 2u * node);
    let b = facet_plane(layer, below, 2u * node + vec2u(1u, 0u));
    let c = facet_plane(layer, below, 2u * node + vec2u(0u, 1u));
    let d = facet_plane(layer, below, 2u * node + 1u);
    let opened = vec4f(0.0, 0.0, 0.0, -1.0);
    let centres = vec4f(a.x, b.x, c.x, d.x);
    // All four are planes, or nothing is in any of them.
    if (min(min(a.w, b.w), min(c.w, d.w)) < 0.0) {
        return opened;
    }
    if (all(centres >= vec4f(NEVER))) {
        return vec4f(NEVER, 0.0, 0.0, 0.0);
    }
    if (any(centres >= vec4f(NEVER))) {
        return opened;
    }
    // The least-squares plane of their middles, and the most that theirs differ from it.
    let size = f32(1u << below);
    let slope = vec2f(b.x - a.x + d.x - c.x, c.x - a.x + d.x - b.x) / (2.0 * size);
    var off = 0.25 * abs(a.x + d.x - b.x - c.x);
    if (below > 0u) {
        let turn = max(
            max(turned(a, slope), turned(b, slope)), max(turned(c, slope), turned(d, slope)));
        off += 0.5 * size * turn + max(max(a.w, b.w), max(c.w, d.w));
    }
    // As good as the tolerance, and no step.
    let middle = 0.25 * (a.x + b.x + c.x + d.x);
    let unit = texel_in_depth(layer, middle);
    let fits = off <= tree.tolerance * unit && abs(slope.x) + abs(slope.y) <= STEEPEST * unit;
    return select(opened, vec4f(middle, slope, off), fits);
}

// How much slopes differ.
fn turned(plane: vec4f, slope: vec2f) -> f32 {
    return abs(plane.y - slope.x) + abs(plane.z - slope.y);
}

// Whether the finer squares along all four sides are whole, so that no neighbour is finer by two.
fn is_balanced(layer: u32, node: vec2u) -> bool {
    let last = vec2i(i32(tree.side >> (tree.level - 1u))) - 1;
    let first = 2 * vec2i(node);
    for (var k = 0; k < 8; k++) {
        let along = k & 1;
        let side = (k >> 1u) & 1;
        let across = select(-1, 2, side == 1);
        let child = first + select(vec2i(along, across), vec2i(across, along), k < 4);
        if (all(child >= vec2i(0)) && all(child <= last)
            && !is_whole(layer, tree.level - 1u, vec2u(child))) {
            return false;
        }
    }
    return true;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= vec2u(tree.side >> tree.level))) {
        return;
    }
    // The plane that fits, unless a neighbour were finer by two levels.
    var plane = fitted(id.z, id.xy);
    if (plane.w >= 0.0 && !is_balanced(id.z, id.xy)) {
        plane.w = -1.0;
    }
    facets[bounds_index(tree.side, id.z, tree.level, id.xy)] = plane;
}
