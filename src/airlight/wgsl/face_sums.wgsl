// What is summed around the four corners of a cell's faces. The including pass binds `sums` and says params.count, cells,
// and params.units.
//! use blocker_sums
//! use cell_order

const LARGEST_SHIFT = 0.5;    // cells from a face to the walls that are counted on it

struct CellFace {
    corner: vec3u,
    across: vec3u,
    up: vec3u,
}

fn value(corner: vec3u, index: u32) -> f32 {
    return f32(sums[CORNER_VALUES * cell_in(params.count + 1u, corner) + index]);
}

// At the face's four corners.
fn around_face(f: CellFace, index: u32) -> vec4f {
    return vec4f(value(f.corner, index), value(f.corner + f.across, index), value(f.corner + f.up, index),
        value(f.corner + f.across + f.up, index)) / params.units;
}

// The mean over the face's four corners.
fn on_face(f: CellFace, index: u32) -> f32 {
    return 0.25 / params.units * (value(f.corner, index) + value(f.corner + f.across, index)
        + value(f.corner + f.up, index) + value(f.corner + f.across + f.up, index));
}

// The face through which a cell's light leaves on a hop.
fn face_of(cell: vec3u, hop: u32) -> CellFace {
    let x = vec3u(1u, 0u, 0u);
    let y = vec3u(0u, 1u, 0u);
    let z = vec3u(0u, 0u, 1u);
    switch (hop) {
        case 0u: { return CellFace(cell + x, y, z); }
        case 1u: { return CellFace(cell, y, z); }
        case 2u: { return CellFace(cell + y, x, z); }
        case 3u: { return CellFace(cell, x, z); }
        case 4u: { return CellFace(cell + z, x, y); }
        default: { return CellFace(cell, x, y); }
    }
}

// Where the backmost of a side's surfaces around a face is, along that side's outward axis; 1: there is none.
fn backmost(f: CellFace, side: u32) -> f32 {
    let code = max(max(value(f.corner, SIDE_BEHIND + side),
        value(f.corner + f.across, SIDE_BEHIND + side)),
        max(value(f.corner + f.up, SIDE_BEHIND + side),
        value(f.corner + f.across + f.up, SIDE_BEHIND + side)));
    return select(1.0, outward_of(code), code > 0.0);
}
