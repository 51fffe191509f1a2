// One hop of the larger lattice's light into the cells along the finer lattice's sides: what their
// neighbours beyond the border would send them, if there were any.
//! use step26
//! use open_line
//! use outer_cells
//! use channel_cells
//! use octants

const DEPTH = 3;        // cells from the border that are asked whether light could leave

// Bodies stop light with their outside: what the larger lattice mistakes for light inside a wall would
// come out of it. So nothing enters where none could leave.
fn open_side(cell: vec3i, axis: u32, is_high: bool) -> f32 {
    var open = 1.0;
    var inner = cell;
    for (var k = 0; k < DEPTH; k++) {
        open *= open_face(inner, axis, is_high);
        inner[axis] += select(1, -1, is_high);
    }
    return open;
}

// A state of the larger lattice as cells of the finer one would have it, for their medium's sigma_t: of
// equal fluence, which is track by volume.
fn gain(sigma_t: f32) -> f32 {
    let volumes = pow(lattice.cell / outer.cell, 3.0);
    return volumes * mean_track(vec3f(sigma_t), outer.cell).x
        / mean_track(vec3f(sigma_t), lattice.cell).x;
}

// The larger lattice's state at a place in its warped cells, trilinear.
fn outer_state(place: vec3f, channel: u32) -> vec4f {
    let at = clamp(place, vec3f(0.5), vec3f(outer.count) - 0.5) - 0.5;
    let first = min(vec3u(at), outer.count - 2u);
    let t = at - vec3f(first);
    var sum = vec4f(0.0);
    for (var k = 0u; k < 8u; k++) {
        let corner = octant(k);
        let share = select(1.0 - t, t, corner == vec3u(1u));
        sum += share.x * share.y * share.z * outer_sum[index_in(outer.count, first + corner, channel)];
    }
    return sum;
}

// A neighbour beyond the border; those inside send their light themselves.
fn cell_beside(at: vec3i, channel: u32, step: vec3i) -> Cell {
    let beside = at + step;
    let below = beside < vec3i(0);
    let above = beside >= vec3i(params.count);
    if (!any(below | above)) {
        return homogeneous_cell(vec4f(0.0));
    }
    // Where it is in the larger lattice; both have the same axes.
    let here = unwarped_coordinates(lattice, vec3u(at), vec3f(0.5)) + vec3f(step);
    let coordinates = (lattice.origin + here * lattice.cell - outer.origin) / outer.cell;
    if (any(coordinates < vec3f(0.0)) || any(coordinates > vec3f(outer.count))) {
        return homogeneous_cell(vec4f(0.0));
    }
    // As far as the sides that it comes through are open.
    var open = 1.0;
    for (var axis = 0u; axis < 3u; axis++) {
        if (below[axis] || above[axis]) {
            open *= open_side(at, axis, above[axis]);
        }
    }
    let place = outer_place(coordinates);
    let state = open * outer_state(place, channel);
    if (IS_VARIED) {
        let cell = vec3u(clamp(place, vec3f(0.0), vec3f(outer.count) - 0.5));
        let there = outer_medium[index_in(outer.count, cell, channel)];
        return varied_cell(gain(there.y) * state, there);
    }
    return homogeneous_cell(gain(outside.sigma_t[channel]) * state
        * coefficients[params.row + channel].gain);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let cell = channel_cell(params.count, id);
    let is_within = all(cell.at > vec3u(0u)) && all(cell.at < params.count - 1u);
    if (!cell.is_there || is_within) {
        return;
    }
    // The cell without light of its own, and its medium.
    let index = index_in(params.count, cell.at, cell.channel);
    var own = homogeneous_cell(vec4f(0.0));
    var c = coefficients[params.row + cell.channel];
    if (IS_VARIED) {
        own = varied_cell(vec4f(0.0), medium[index]);
        c = varied_coefficients(own);
    }
    // Walls are asked above; between neighbours inside there is nothing to stop.
    var walls = no_walls();
    cells[index] += exchanged(Here(vec3i(cell.at), cell.channel, own, c), &walls);
}
