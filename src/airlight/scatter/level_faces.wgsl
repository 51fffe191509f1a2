// Visibility of a coarse cell's incoming face hops: walls on the face, and whole those half a coarse
// cell before or behind it. A wall through the middle of a coarse cell closes both its faces: a
// correction may be too small, but is never handed through a wall.
//! use level_cells
//! use channel_cells
//! use entering_share

// How closed fine plane `plane` (the low faces of cells there) is for hop 2 axis + side, averaged
// over the 2 x 2 fine faces of the coarse cell at `first` (fine cells).
fn closed(first: vec3u, axis: u32, plane: i32, side: u32) -> f32 {
    let f = params.fine;
    // Nothing comes in through the lattice's border.
    if (plane <= 0 || plane >= i32(f[axis])) {
        return 0.0;
    }
    // A hop back enters the cell below the plane.
    let layer = plane - i32(side);
    let across = (axis + 1u) % 3u;
    let up = (axis + 2u) % 3u;
    var total = vec2f(0.0);
    for (var k = 0u; k < 4u; k++) {
        var p = first;
        p[axis] = u32(layer);
        p[across] += k & 1u;
        p[up] += k >> 1u;
        if (all(p < f)) {
            let open = entering_share(face_visibility[index_in(f, p, 0u)], 2u * axis + side);
            total += vec2f(1.0 - open, 1.0);
        }
    }
    return total.x / max(total.y, 1.0);
}

// How open a coarse face is past the three fine planes that belong to it.
fn open_face(at: vec3u, axis: u32, side: u32) -> f32 {
    let plane = 2 * i32(at[axis] + side);
    let first = 2u * at;
    return 1.0 - saturate(closed(first, axis, plane, side) + closed(first, axis, plane - 1, side)
        + closed(first, axis, plane + 1, side));
}

fn mean_reflectance(at: vec3u) -> vec4f {
    let f = params.fine;
    var total = vec4f(0.0);
    for (var k = 0u; k < 8u; k++) {
        let p = min(fine_cell(at, k), f - 1u);
        total += unpack4x8unorm(reflectance[index_in(f, p, 0u)]);
    }
    return 0.125 * total;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.coarse)) {
        return;
    }
    let cell = index_in(params.coarse, id, 0u);
    // +x -x +y -y, +z -z; two bytes are not read.
    coarse_face_visibility[cell] = vec2u(
        pack4x8unorm(vec4f(open_face(id, 0u, 0u), open_face(id, 0u, 1u), open_face(id, 1u, 0u),
            open_face(id, 1u, 1u))),
        pack4x8unorm(vec4f(open_face(id, 2u, 0u), open_face(id, 2u, 1u), 1.0, 1.0)));
    coarse_reflectance[cell] = pack4x8unorm(mean_reflectance(id));
}
