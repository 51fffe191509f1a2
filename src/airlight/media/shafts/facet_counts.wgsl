// How many triangles the leaves within each square have.
//! use facets

// Those of a leaf: both ends of its column, and walls towards neighbours that it is in charge of.
fn triangles_of(layer: u32, level: u32, node: vec2u) -> u32 {
    let own = facet_of(layer, level, node);
    let bits = leaf_sides(layer, own);
    var sum = 2u * top_triangles(own, bits);
    for (var side = 0u; side < 4u; side++) {
        if ((bits >> (4u + side) & 1u) == 1u) {
            let halves = wall_triangles(layer, own, beyond(layer, own, side).facet, side);
            sum += halves.x + halves.y;
        }
    }
    return sum;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= vec2u(tree.side >> tree.level)) || is_in_whole(id.z, tree.level, id.xy)) {
        return;
    }
    // Of the leaf itself, or of the four squares within.
    var sum = 0u;
    if (is_whole(id.z, tree.level, id.xy)) {
        sum = triangles_of(id.z, tree.level, id.xy);
    } else {
        for (var k = 0u; k < 4u; k++) {
            let child = 2u * id.xy + vec2u(k & 1u, k >> 1u);
            if (tree.level == 1u) {
                sum += triangles_of(id.z, 0u, child);
            } else {
                sum += places[bounds_index(tree.side, id.z, tree.level - 1u, child)];
            }
        }
    }
    places[bounds_index(tree.side, id.z, tree.level, id.xy)] = sum;
}
