// Volumes as blockers of a lattice: what they reflect and stop on each hop, on top of its walls (two-stream
// model, Schuster1905). `known` has the faces for light that volumes send: walls reflect only where the volumes' own
// solvers know them.
//! use cell_order
//! use lattice_axes
//! use medium
//! use column_spread

// What a layer of reduced depth `depth.a` reflects, rgb, and blocks, a; see maths/two_streams.py.
fn layer(depth: vec4f) -> vec4f {
    let albedo = min(depth.rgb / max(depth.a, 1e-12), vec3f(1.0));
    // What collides is absorbed, or scattered to both sides alike, again and again.
    let decay = sqrt(1.0 - albedo);
    let far = exp(-decay * depth.a);
    let rise = 2.0 * depth.a * mean_transmittance_rgb(2.0 * decay * depth.a);
    let lost = 1.0 + far * far + (1.0 - 0.5 * albedo) * rise;
    let onwards = 2.0 * far / lost;
    return vec4f(0.5 * albedo * rise / lost, 1.0 - (onwards.r + onwards.g + onwards.b) / 3.0);
}

// A cell's index, inside the lattice.
fn index_at(cell: vec3i) -> u32 {
    let inside = clamp(cell, vec3i(0), vec3i(lattice.count) - 1);
    return cell_in(lattice.count, vec3u(inside));
}

// The largest half of a column in a cell over their mean; 0: they are alike.
fn largest_half(cell: u32) -> f32 {
    return bitcast<f32>(spread[SPREAD_WORDS * cell + LARGEST_WORD]);
}

// The extinction of half a column over the cell's; `largest` as above.
fn half_of(cell: u32, face: u32, column: u32, largest: f32) -> f32 {
    let h = half_column(face, column);
    let bits = spread[SPREAD_WORDS * cell + h / HALVES_PER_WORD] >> (4u * (h % HALVES_PER_WORD));
    return select(1.0, largest * f32(bits & 15u) / HALF_STEPS, largest > 0.0);
}

// What hop 0..5 (+x -x +y -y +z -z) between a cell and the next meets: rgb reflected, a blocked.
fn met(cell: vec3u, hop: u32) -> vec4f {
    var step = vec3i(0);
    step[hop / 2u] = select(1, -1, (hop & 1u) == 1u);
    let one = index_at(vec3i(cell));
    let other = index_at(vec3i(cell) + step);
    let half = 0.5 * lattice.cell;
    let near = largest_half(one);
    let far = largest_half(other);
    if (near == 0.0 && far == 0.0) {
        return layer(half * (cells[one] + cells[other]));
    }
    // A medium that fills a part of a cell stops a part of its light: columns side by side, each a layer.
    var sum = vec4f(0.0);
    for (var c = 0u; c < COLUMNS; c++) {
        sum += layer(half * (half_of(one, hop, c, near) * cells[one] + half_of(other, hop ^ 1u, c, far) * cells[other]));
    }
    return sum / f32(COLUMNS);
}

// What a wall and media reflect and stop together of light that leaves.
fn leaving(wall: u32, media: vec4f) -> u32 {
    let shares = unpack4x8unorm(wall);
    let open = 1.0 - shares.a;
    return pack4x8unorm(vec4f(shares.rgb + open * media.rgb, shares.a + open * media.a));
}

// Whether a wall between a cell and the next one is as near to a volume's grid as the volume's solver looks for walls.
fn is_known(cell: vec3u, hop: u32) -> bool {
    var at = vec3f(cell) + 0.5;
    at[hop / 2u] += select(0.5, -0.5, (hop & 1u) == 1u);
    let p = vec4f(world_from_cells(lattice, at), 1.0);
    for (var k = 0u; k < params.boxes; k++) {
        let inside = (boxes[k] * p).xyz;
        if (all(inside >= vec3f(0.0)) && all(inside <= vec3f(1.0))) {
            return true;
        }
    }
    return false;
}

// The same face without what the wall reflects, unless it is known.
fn known_wall(wall: u32, cell: vec3u, hop: u32) -> u32 {
    return select(wall & 0xff000000u, wall, (wall & 0xffffffu) == 0u || is_known(cell, hop));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let cell = cell_in(lattice.count, id);
    // Media on the six hops, then walls and media together, packed as lattice.blockers.Blockers.faces.
    var hops = array<vec4f, 6>();
    for (var hop = 0u; hop < 6u; hop++) {
        hops[hop] = met(id, hop);
    }
    let side = walls[2u * cell];
    let rest = walls[2u * cell + 1u];
    // A hop +x comes in through the face towards -x.
    let xy = unpack4x8unorm(rest.z) * (1.0 - vec4f(hops[1].a, hops[0].a, hops[3].a, hops[2].a));
    let z = unpack4x8unorm(rest.w) * (1.0 - vec4f(hops[5].a, hops[4].a, 0.0, 0.0));
    let entering = vec2u(pack4x8unorm(xy), pack4x8unorm(z));
    faces[2u * cell] = vec4u(leaving(side.x, hops[0]), leaving(side.y, hops[1]),
        leaving(side.z, hops[2]), leaving(side.w, hops[3]));
    faces[2u * cell + 1u] = vec4u(leaving(rest.x, hops[4]), leaving(rest.y, hops[5]), entering);
    // Walls that the volumes' solvers do not know are black.
    known[2u * cell] = vec4u(
        leaving(known_wall(side.x, id, 0u), hops[0]), leaving(known_wall(side.y, id, 1u), hops[1]),
        leaving(known_wall(side.z, id, 2u), hops[2]), leaving(known_wall(side.w, id, 3u), hops[3]));
    known[2u * cell + 1u] = vec4u(leaving(known_wall(rest.x, id, 4u), hops[4]),
        leaving(known_wall(rest.y, id, 5u), hops[5]), entering);
}
