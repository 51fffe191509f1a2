// Volumes as blockers of a lattice: what they reflect and stop on each hop, on top of its walls (two-stream
// model, Schuster1905).
//! use cell_order

// What a hop between two cells meets: rgb reflected, a blocked.
fn met(one: vec4f, other: vec4f) -> vec4f {
    // What collides is absorbed, or scattered to both sides alike.
    let depth = 0.5 * (one + other) * lattice.cell;
    let collided = 1.0 - exp(-depth.a);
    let back = 0.5 * collided * min(depth.rgb / max(depth.a, 1e-12), vec3f(1.0));
    let onwards = (back.r + back.g + back.b) / 3.0;
    return vec4f(back, collided - onwards);
}

fn cell_at(cell: vec3i) -> vec4f {
    let inside = clamp(cell, vec3i(0), vec3i(lattice.count) - 1);
    return cells[cell_in(lattice.count, vec3u(inside))];
}

// Towards hop 0..5 (+x -x +y -y +z -z).
fn beside(cell: vec3u, hop: u32) -> vec4f {
    var step = vec3i(0);
    step[hop / 2u] = select(1, -1, (hop & 1u) == 1u);
    return cell_at(vec3i(cell) + step);
}

// What a wall and media reflect and stop together of light that leaves.
fn leaving(wall: u32, media: vec4f) -> u32 {
    let shares = unpack4x8unorm(wall);
    let open = 1.0 - shares.a;
    return pack4x8unorm(vec4f(shares.rgb + open * media.rgb, shares.a + open * media.a));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let cell = cell_in(lattice.count, id);
    let here = cells[cell];
    // Media on the six hops, then walls and media together, packed as lattice.blockers.Blockers.faces.
    var hops = array<vec4f, 6>();
    for (var hop = 0u; hop < 6u; hop++) {
        hops[hop] = met(here, beside(id, hop));
    }
    let side = walls[2u * cell];
    let rest = walls[2u * cell + 1u];
    // A hop +x comes in through the face towards -x.
    let xy = unpack4x8unorm(rest.z) * (1.0 - vec4f(hops[1].a, hops[0].a, hops[3].a, hops[2].a));
    let z = unpack4x8unorm(rest.w) * (1.0 - vec4f(hops[5].a, hops[4].a, 0.0, 0.0));
    faces[2u * cell] = vec4u(leaving(side.x, hops[0]), leaving(side.y, hops[1]),
        leaving(side.z, hops[2]), leaving(side.w, hops[3]));
    faces[2u * cell + 1u] = vec4u(leaving(rest.x, hops[4]), leaving(rest.y, hops[5]),
        pack4x8unorm(xy), pack4x8unorm(z));
}
