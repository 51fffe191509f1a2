// From the root down: where each square's triangles begin, and the leaves' triangles themselves.
//! use facets

// Each writes triangles from an index on, and returns the next one.
fn put(at: u32, own: Facet, kind: u32) -> u32 {
    if (at < arrayLength(&triangles)) {
        triangles[at] = packed_triangle(own.level, own.node, kind);
    }
    return at + 1u;
}

// The top's two halves or its fan, and the same again at infinity: `kind` is 0 or LID.
fn put_top(first: u32, own: Facet, split: u32, kind: u32) -> u32 {
    if (split == 0u) {
        return put(put(first, own, kind), own, kind + 1u);
    }
    var at = first;
    for (var side = 0u; side < 4u; side++) {
        if ((split >> side & 1u) == 1u) {
            at = put(put(at, own, kind + 6u + 2u * side), own, kind + 7u + 2u * side);
        } else {
            at = put(at, own, kind + 2u + side);
        }
    }
    return at;
}

fn put_leaf(level: u32, node: vec2u, first: u32) -> u32 {
    let own = facet_of(tree.layer, level, node);
    let bits = leaf_sides(tree.layer, own);
    var at = first;
    // Both ends of its column: the top, and the same at infinity. Where nothing casts a shadow there is no column.
    if (own.plane.x < NEVER) {
        at = put_top(put_top(at, own, bits & 15u, 0u), own, bits & 15u, LID);
    }
    // Walls on the sides that it is in charge of, in two halves.
    for (var side = 0u; side < 4u; side++) {
        if ((bits >> (4u + side) & 1u) == 1u) {
            let halves = wall_triangles(
                tree.layer, own, beyond(tree.layer, own, side).facet, side);
            for (var j = 0u; j < halves.x + halves.y; j++) {
                let part = select(j, 3u + j - halves.x, j >= halves.x);
                at = put(at, own, WALL + 6u * side + part);
            }
        }
    }
    return at;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let layer = tree.layer;
    if (any(id.xy >= vec2u(tree.side >> tree.level)) || is_in_whole(layer, tree.level, id.xy)) {
        return;
    }
    // Where this square's own begin; at the root, where their number says how much there is to draw.
    var at = places[bounds_index(tree.side, layer, tree.level, id.xy)];
    if (tree.level == tree.top) {
        draws[layer] = Draw(3u * min(at, arrayLength(&triangles)), 1u, 0u, 0u);
        at = 0u;
    }
    // A leaf writes its triangles; any other square hands its children their places, in turn.
    if (is_whole(layer, tree.level, id.xy)) {
        at = put_leaf(tree.level, id.xy, at);
        return;
    }
    for (var k = 0u; k < 4u; k++) {
        let child = 2u * id.xy + vec2u(k & 1u, k >> 1u);
        if (tree.level == 1u) {
            at = put_leaf(0u, child, at);
        } else {
            let entry = bounds_index(tree.side, layer, tree.level - 1u, child);
            let count = places[entry];
            places[entry] = at;
            at += count;
        }
    }
}
