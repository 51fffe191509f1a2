// Packs 2 and 3 of every cell (1 - b of Billeter2012 eq. 2): the open shares of its own hops by their number, and the walls'
// reflectance. maths.lattice26_walls.open_hops is the NumPy twin.
//! use hops26
//! use packed_hops
//! use entering_share
//! use cell_order

// The open share of the face that a step of `step` along an axis crosses into a cell; outside,
// nothing stops light.
fn open_face(cell: vec3i, axis: u32, step: i32) -> f32 {
    if (any(cell < vec3i(0)) || any(cell >= vec3i(params.count))) {
        return 1.0;
    }
    let c = vec3u(cell);
    let index = cell_in(params.count, c);
    return entering_share(face_visibility[index], 2u * axis + select(0u, 1u, step < 0));
}

// The part of a hop along one axis.
fn part_along(step: vec3i, axis: u32) -> vec3i {
    var part = vec3i(0);
    part[axis] = step[axis];
    return part;
}

// Along one axis of a hop from `at`; 1 where the hop does not go along it.
fn open_one(at: vec3i, step: vec3i, axis: u32) -> f32 {
    return select(1.0, open_face(at + part_along(step, axis), axis, step[axis]), step[axis] != 0);
}

// Along two axes of it: either first, equally likely.
fn open_two(at: vec3i, step: vec3i, a: u32, b: u32) -> f32 {
    if (step[a] == 0 || step[b] == 0) {
        return open_one(at, step, a) * open_one(at, step, b);
    }
    let end = at + part_along(step, a) + part_along(step, b);
    return 0.5 * (open_one(at, step, a) * open_face(end, b, step[b])
        + open_one(at, step, b) * open_face(end, a, step[a]));
}

// A hop across an edge or a corner goes along its axes in any order, past faces on each path: each of them last, equally
// likely.
fn open_hop(at: vec3i, hop: u32) -> f32 {
    let step = hop_offset(hop);
    if (any(step == vec3i(0))) {
        let first = select(0u, 1u, step.x == 0);
        let second = select(1u, 2u, step.x == 0 || step.y == 0);
        return open_two(at, step, first, second);
    }
    let end = at + step;
    return (open_two(at, step, 0u, 1u) * open_face(end, 2u, step.z)
        + open_two(at, step, 0u, 2u) * open_face(end, 1u, step.y)
        + open_two(at, step, 1u, 2u) * open_face(end, 0u, step.x)) / 3.0;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cell = cell_in(params.count, id);
    // The second half, and the colour of the walls that turn light back.
    let words = packed_hops(vec3i(id));
    packs[4u * cell + 2u] = vec4u(words[0], words[1], words[2], words[3]);
    packs[4u * cell + 3u] = vec4u(words[4], words[5], words[6], reflectance[cell]);
}
