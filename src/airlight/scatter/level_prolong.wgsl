// change = the summed states whose track is an eighth of the coarse cell's. Where a wall
// runs through a coarse cell its light goes to the fine cells by what they hold already, so that
// none appears behind the wall.

//! use hops26
//! use level_cells
//! use channel_cells
//! use entering_share

const CLOSED = 0.05;

// The smallest open share among the faces inside the coarse cell that holds `at`.
fn inner_face_visibility(at: vec3u) -> f32 {
    let f = params.fine;
    var open = 1.0;
    for (var k = 0u; k < 8u; k++) {
        let p = fine_cell(at / 2u, k);
        if (any(p >= f)) {
            continue;
        }
        // A hop along +x enters through a cell's low face: inside for the upper of two cells.
        let packed = face_visibility[index_in(f, p, 0u)];
        for (var axis = 0u; axis < 3u; axis++) {
            open = min(open, entering_share(packed, 2u * axis + 1u - (p[axis] & 1u)));
        }
    }
    return open;
}

// The share, times 8, of the coarse cell's light that `at` gets, by what it holds.
fn held_share(at: vec3u, channel: u32) -> f32 {
    let f = params.fine;
    var total = 0.0;
    for (var k = 0u; k < 8u; k++) {
        let p = fine_cell(at / 2u, k);
        if (all(p < f)) {
            total += max(0.0, sum[index_in(f, p, channel)].x);
        }
    }
    let own = max(0.0, sum[index_in(f, at, channel)].x);
    return select(0.0, 8.0 * own / total, total > 0.0);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let f = params.fine;
    let channel = id.z / f.z;
    if (id.x >= f.x || id.y >= f.y || channel >= 3u) {
        return;
    }
    let at = vec3u(id.xy, id.z % f.z);
    let index = index_in(f, at, channel);
    // The states that leave the track: as much as an isotropic state leaves on a hop.
    var per_hop = params.track[channel];
    if ((params.flags & 2u) != 0u) {
        per_hop = mean_track(vec3f(medium[index].y), params.cell).x;
    }
    // All eight cells alike, or, where a wall parts them, as they are lit.
    var share = 0.125 / per_hop;
    if ((params.flags & 1u) != 0u && inner_face_visibility(at) < 1.0 - CLOSED) {
        share *= held_share(at, channel);
    }
    let found = track[index_in(params.coarse, at / 2u, channel)];
    // The track holds the net direction as hops leave it.
    change[index] = share * vec4f(found.x, 3.0 / (RHO * RHO) * found.yzw);
}
