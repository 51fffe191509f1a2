// A shadow map told as a quad-tree of planar facets, neighbours at most one level apart; see
// media/shafts/facets.py. The including pass declares FacetParams `tree`, `shadows` and `facets`.
// Corners of a square run +x -y, +x +y, -x +y, -x -y; side i goes from corner i to the next.
//! use depth_bounds

struct Facet {
    level: u32,
    node: vec2u,
    plane: vec4f,   // depth in the middle (NEVER: nothing there), slope per texel in x and y, error
}

// What lies beyond a side of a leaf of the tree.
struct Beyond {
    is_split: bool,     // two finer leaves, which draw the wall between
    is_walled: bool,    // a wall that this leaf draws
    facet: Facet,
}

fn texel_depth(layer: u32, texel: vec2u) -> f32 {
    if (any(texel >= vec2u(tree.resolution))) {
        return NEVER;
    }
    return shadow_depth(textureLoad(shadows, vec2i(texel), layer, 0));
}

fn facet_plane(layer: u32, level: u32, node: vec2u) -> vec4f {
    if (level == 0u) {
        return vec4f(texel_depth(layer, node), 0.0, 0.0, 0.0);
    }
    return facets[bounds_index(tree.side, layer, level, node)];
}

// Whether one plane fits a whole square: else it is opened.
fn is_whole(layer: u32, level: u32, node: vec2u) -> bool {
    return level == 0u || facets[bounds_index(tree.side, layer, level, node)].w >= 0.0;
}

fn is_in_whole(layer: u32, level: u32, node: vec2u) -> bool {
    return level < tree.top && is_whole(layer, level + 1u, node / 2u);
}

fn corner_of(i: u32) -> vec2u {
    return vec2u(select(0u, 1u, i < 2u), select(0u, 1u, i == 1u || i == 2u));
}

// The depth of a facet's plane at a lattice point, texels.
fn depth_at(facet: Facet, at: vec2u) -> f32 {
    if (facet.plane.x >= NEVER) {
        return NEVER;
    }
    // In units of half a texel, exact; and rounded once per axis, wherever this is inlined: corners
    // that meet are to be the same bits.
    let off = 2 * vec2i(at) - (2 * vec2i(facet.node) + 1) * (1 << facet.level);
    let x = fma(0.5 * facet.plane.y, f32(off.x), facet.plane.x);
    return fma(0.5 * facet.plane.z, f32(off.y), x);
}

fn facet_of(layer: u32, level: u32, node: vec2u) -> Facet {
    return Facet(level, node, facet_plane(layer, level, node));
}

fn side_ends(level: u32, node: vec2u, side: u32) -> array<vec2u, 2> {
    return array<vec2u, 2>(
        (node + corner_of(side)) << vec2u(level),
        (node + corner_of((side + 1u) & 3u)) << vec2u(level));
}

// Of a leaf. Sides are +x +y -x -y; of equal neighbours the lower draws the wall.
fn beyond(layer: u32, own: Facet, side: u32) -> Beyond {
    let step = select(vec2i(1, 0), vec2i(0, 1), (side & 1u) == 1u) * select(1, -1, side > 1u);
    let beside = vec2i(own.node) + step;
    var result: Beyond;
    var is_own = true;
    result.facet = Facet(own.level, vec2u(beside), vec4f(NEVER, 0.0, 0.0, 0.0));
    // What lies on the other side: a larger leaf, one of the same size, or smaller ones.
    if (all(beside >= vec2i(0)) && all(beside < vec2i(i32(tree.side >> own.level)))) {
        let node = vec2u(beside);
        if (is_in_whole(layer, own.level, node)) {
            result.facet = facet_of(layer, own.level + 1u, node / 2u);
        } else if (is_whole(layer, own.level, node)) {
            result.facet = facet_of(layer, own.level, node);
            is_own = side < 2u;
        } else {
            result.is_split = true;
            return result;
        }
    }
    // A wall stands between both where their depths differ at an end of the side.
    if (is_own) {
        let ends = side_ends(own.level, own.node, side);
        result.is_walled = depth_at(own, ends[0]) != depth_at(result.facet, ends[0])
            || depth_at(own, ends[1]) != depth_at(result.facet, ends[1]);
    }
    return result;
}

// Which sides of a leaf are split, in bits 0 to 3, and which it draws walls at, in bits 4 to 7.
fn leaf_sides(layer: u32, own: Facet) -> u32 {
    var bits = 0u;
    for (var side = 0u; side < 4u; side++) {
        let other = beyond(layer, own, side);
        bits |= (select(0u, 1u, other.is_split) | select(0u, 16u, other.is_walled)) << side;
    }
    return bits;
}

// Triangles of a leaf's top: two, or a fan where a side is split.
fn top_triangles(own: Facet, bits: u32) -> u32 {
    let split = bits & 15u;
    return select(select(4u + countOneBits(split), 2u, split == 0u), 0u, own.plane.x >= NEVER);
}

// A triangle is its leaf's square and what it is of it: 0, 1 the top's halves; 2 + i the fan's
// triangle at a whole side i, 6 + 2 i + h at half a side; LID more: the same at infinity;
// WALL + 6 i + 3 h + j the j-th triangle of a half of the wall at side i.
const LID = 14u;
const WALL = 28u;
const KINDS = 52u;

fn packed_triangle(level: u32, node: vec2u, kind: u32) -> u32 {
    var index = node.y * (tree.side >> level) + node.x;
    if (level > 0u) {
        index = tree.side * tree.side + bounds_index(tree.side, 0u, level, node);
    }
    return index * KINDS + kind;
}

// The leaf's level and square, from a packed triangle.
fn leaf_of(packed: u32) -> vec3u {
    var index = packed / KINDS;
    var level = 0u;
    var count = tree.side * tree.side;
    while (index >= count) {
        index -= count;
        count /= 4u;
        level++;
    }
    let width = tree.side >> level;
    return vec3u(index % width, index / width, level);
}

fn leaf_at(layer: u32, texel: vec2u, near: u32) -> Facet {
    var level = near;
    while (!is_whole(layer, level, texel >> vec2u(level))) {
        level--;
    }
    while (is_in_whole(layer, level, texel >> vec2u(level))) {
        level++;
    }
    return facet_of(layer, level, texel >> vec2u(level));
}

// Depths between a and b of the leaves around a lattice point, from a on: where other walls end
// at this one's upright edge, it has to have corners, too. NEVER fills up.
fn depths_between(layer: u32, at: vec2u, near: u32, a: f32, b: f32) -> vec2f {
    var found = vec2f(NEVER);
    for (var k = 0u; k < 4u; k++) {
        let texel = vec2i(at) - vec2i(i32(k & 1u), i32(k >> 1u));
        if (any(texel < vec2i(0)) || any(texel >= vec2i(i32(tree.side)))) {
            continue;
        }
        let depth = depth_at(leaf_at(layer, vec2u(texel), near), at);
        // Beyond the wall's own ends, or at one that is known, there is nothing to add.
        if (depth <= min(a, b) || depth >= max(a, b) || depth == found.x) {
            continue;
        }
        // Two at most, in order from a on.
        let is_first = found.x >= NEVER || (depth < found.x) == (a < b);
        found = select(found, vec2f(depth, found.x), is_first);
        if (found.x != depth && found.y >= NEVER) {
            found.y = depth;
        }
    }
    return found;
}

// Triangles of the two halves of a wall: P Q Q' is cut at Q's upright edge, Q' P' P at P's.
fn wall_triangles(layer: u32, own: Facet, other: Facet, side: u32) -> vec2u {
    let ends = side_ends(own.level, own.node, side);
    var counts = vec2u(1u);
    for (var h = 0u; h < 2u; h++) {
        let at = ends[1u - h];
        let cuts = depths_between(layer, at, own.level, depth_at(own, at), depth_at(other, at));
        counts[h] += select(0u, 1u, cuts.x < NEVER) + select(0u, 1u, cuts.y < NEVER);
    }
    return counts;
}
