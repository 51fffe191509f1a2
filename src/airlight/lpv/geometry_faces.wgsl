// The shares that propagation reads, as lattice/face_visibility.wgsl writes them, from the geometry volume
// (Kaplanyan2010 section 3.2).
//! use cell_order

struct Blocked {
    share: f32,
    reflectance: f32,
}

// +x -x +y -y +z -z
fn direction_of(hop: u32) -> vec3f {
    var d = vec3f(0.0);
    d[hop / 2u] = select(-1.0, 1.0, (hop & 1u) == 0u);
    return d;
}

// What blocks light that leaves a cell on a hop: the mean of the four corners of the crossed face.
fn blocked(cell: vec3u, hop: u32) -> Blocked {
    let axis = hop / 2u;
    let size = params.count + 1u;
    var sum = vec4f(0.0);
    var reflects = 0.0;
    for (var k = 0u; k < 4u; k++) {
        var corner = cell;
        corner[axis] += select(1u, 0u, (hop & 1u) == 1u);
        corner[(axis + 1u) % 3u] += k & 1u;
        corner[(axis + 2u) % 3u] += k >> 1u;
        let index = cell_in(size, corner);
        sum += 0.25 * volume[index];
        reflects += 0.25 * reflected[index];
    }
    // Its two bands, in the direction that the light comes from.
    let share = saturate(sum.x - dot(sum.yzw, direction_of(hop)));
    return Blocked(share, saturate(reflects / max(sum.x, 1e-6)));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    // The blocker a hop meets as light leaves the cell, and the one its neighbour's light met.
    var leaving = array<u32, 6>();
    var entering = array<f32, 6>();
    for (var hop = 0u; hop < 6u; hop++) {
        let out = blocked(id, hop);
        leaving[hop] = pack4x8unorm(vec4f(vec3f(out.share * out.reflectance), out.share));
        entering[hop] = 1.0;
        // A hop enters from the neighbour that lies against its direction.
        let source = vec3i(id) - vec3i(direction_of(hop));
        if (all(source >= vec3i(0)) && all(source < vec3i(params.count))) {
            entering[hop] = 1.0 - blocked(vec3u(source), hop).share;
        }
    }
    // Packed as lattice.blockers.Blockers.faces.
    let xy = pack4x8unorm(vec4f(entering[0], entering[1], entering[2], entering[3]));
    let zz = pack4x8unorm(vec4f(entering[4], entering[5], 1.0, 1.0));
    let cell = cell_in(params.count, id);
    faces[2u * cell] = vec4u(leaving[0], leaving[1], leaving[2], leaving[3]);
    faces[2u * cell + 1u] = vec4u(leaving[4], leaving[5], xy, zz);
    // The paper's lookup knows no walls.
    let texel = id + vec3u(0u, params.first_row, 0u);
    textureStore(visibility_a, texel, vec4f(1.0));
    textureStore(visibility_b, texel, vec4f(1.0));
}
