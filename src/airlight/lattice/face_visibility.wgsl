// What propagation knows of a cell's six faces (Kaplanyan2010 section 3.2; twin, where nothing ends at a wall:
// maths.lattice6.blocked_shares), eight u32 a cell: for each outgoing hop
// (+x -x +y -y +z -z) the reflected share (rgb) and the closed share (a) as unorm8, then the open
// shares of the six incoming hops as unorm8; and where the walls on its low faces really are.
//! use face_sums
//! use share_between
//! use oblique_plane

const OCCLUSION_GAIN = 1.5;    // closes a wall that falls between two layers of corners
const ENCLOSED_COVER = 0.5;
const SEPARATE = 0.02;     // cells

// Light that travels along `hop` is stopped by what faces it: the other side of the same axis.
fn closed_share(f: CellFace, hop: u32, most: array<vec4f, 2>) -> f32 {
    return saturate(OCCLUSION_GAIN * share_between(around_face(f, hop ^ 1u), most));
}

// The colour of what faces the hop, times its share; and the share.
fn reflected_share(f: CellFace, hop: u32, most: array<vec4f, 2>) -> vec4f {
    let side = hop ^ 1u;
    let covered = max(on_face(f, side), 1e-6);
    let rgb = vec3f(on_face(f, SIDE_REFLECTED + 3u * side),
        on_face(f, SIDE_REFLECTED + 3u * side + 1u), on_face(f, SIDE_REFLECTED + 3u * side + 2u));
    let closed = closed_share(f, hop, most);
    return vec4f(rgb / covered * closed, closed);
}

// Where, in cells from a face, the wall counted on it really lies; 0 where little is there. What stands on a floor lies
// before it: the backmost surface is the wall.
fn wall_shift(f: CellFace, axis: u32, most: array<vec4f, 2>) -> f32 {
    let cover = on_face(f, AXIS_COVER + axis);
    let plus = backmost(f, 2u * axis);
    let minus = backmost(f, 2u * axis + 1u);
    // Two sides of one wall: between them.
    var shift = 0.5 * (plus - minus);
    if (plus < -minus) {
        // A gap between them: the backmost surface of the side that covers more (a floor under a
        // moulding), or, of sheets that block from both sides, where most of their area is.
        let plus_cover = on_face(f, 2u * axis);
        let minus_cover = on_face(f, 2u * axis + 1u);
        shift = on_face(f, AXIS_MOMENT + axis) / max(cover, 1e-6);
        if (plus_cover > 1.3 * minus_cover) { shift = plus; }
        if (minus_cover > 1.3 * plus_cover) { shift = -minus; }
    }
    if (minus >= 1.0) { shift = plus; }
    if (plus >= 1.0) { shift = -minus; }
    if (minus >= 1.0 && plus >= 1.0) { shift = 0.0; }
    let share = share_between(around_face(f, AXIS_COVER + axis), most);
    return clamp(shift, -LARGEST_SHIFT, LARGEST_SHIFT) * smoothstep(0.25, 0.6, share);
}

// Of what counts around the four corners of a cell's face across an axis, in the order of around_face, the part before
// the walls at the ends of the cell's other axes (wall_ends.wgsl).
fn most_on_face(cell: vec3u, axis: u32) -> vec4f {
    let packed = ends[cell_in(params.count, cell)];
    let xy = unpack4x8unorm(packed.x);
    let z = unpack4x8unorm(packed.y).xy;
    let across = select(xy.xy, xy.zw, axis == 0u);
    let up = select(z, xy.zw, axis == 2u);
    return vec4f(across.x * up.x, across.y * up.x, across.x * up.y, across.y * up.y);
}

// And of both cells that the face of a hop lies between.
fn most_between(cell: vec3u, hop: u32) -> array<vec4f, 2> {
    var next = vec3i(cell);
    next[hop / 2u] += select(1, -1, (hop & 1u) == 1u);
    let other = vec3u(clamp(next, vec3i(0), vec3i(params.count) - 1));
    return array<vec4f, 2>(most_on_face(cell, hop / 2u), most_on_face(other, hop / 2u));
}

// Whether a hop ends at a wall of which it is known on which side a point is: one that faces the hop
// more than what faces back (a floor, whatever closed things and sheets stand on it), or alone or apart
// from that. Not sheets alone, nor what is thin and tilted.
fn is_enclosed(f: CellFace, hop: u32) -> bool {
    let facing = on_face(f, hop ^ 1u);
    let along = on_face(f, hop);
    // What faces to both sides is a sheet; what faces back far from it is another wall.
    let sheets = facing + along - on_face(f, AXIS_COVER + hop / 2u);
    let is_apart = along < 0.25
        || (along > ENCLOSED_COVER && abs(backmost(f, hop ^ 1u) + backmost(f, hop)) > SEPARATE);
    return facing - along > ENCLOSED_COVER
        || (facing > ENCLOSED_COVER && sheets < 0.1 && is_apart);
}

// One bit for each outgoing hop that ends at such a wall, as a value of unorm7.
fn enclosed_faces(cell: vec3u) -> f32 {
    var bits = 0u;
    for (var hop = 0u; hop < 6u; hop++) {
        bits |= select(0u, 1u << hop, is_enclosed(face_of(cell, hop), hop));
    }
    return f32(bits) / 127.0;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cell = cell_in(params.count, id);
    // What stops each outgoing and each incoming hop, and what parts the light on both sides of a face.
    var leaving = array<u32, 6>();
    var entering = array<f32, 6>();
    var between = array<f32, 6>();
    var shifts = array<f32, 6>();
    for (var hop = 0u; hop < 6u; hop++) {
        let face = face_of(id, hop);
        let most = most_between(id, hop);
        shifts[hop] = wall_shift(face, hop / 2u, most);
        let reflected = reflected_share(face, hop, most);
        leaving[hop] = pack4x8unorm(reflected);
        // The opposite hop enters through the face that this one leaves by.
        let open = 1.0 - closed_share(face, hop ^ 1u, most);
        entering[hop ^ 1u] = open;
        // Light on both sides of a wall is apart, though light from inside the wall could come out.
        between[hop ^ 1u] = min(open, 1.0 - reflected.a);
    }
    // Packed for propagation, and as textures for lookups and rays.
    let xy = vec4f(entering[0], entering[1], entering[2], entering[3]);
    let zz = vec4f(entering[4], entering[5], 1.0, 1.0);
    faces[2u * cell] = vec4u(leaving[0], leaving[1], leaving[2], leaving[3]);
    faces[2u * cell + 1u] = vec4u(leaving[4], leaving[5], pack4x8unorm(xy), pack4x8unorm(zz));
    face_visibility[cell] = vec2u(pack4x8unorm(xy), pack4x8unorm(zz));
    let texel = id + vec3u(0u, params.first_row, 0u);
    textureStore(visibility_a, texel, vec4f(between[0], between[1], between[2], between[3]));
    // And its low faces across x and y once more: rays find all three in one texture.
    textureStore(visibility_b, texel, vec4f(between[4], between[5], between[0], between[2]));
    textureStore(walls, texel, vec4f(shifts[1], shifts[3], shifts[5], enclosed_faces(id)));
    textureStore(planes, texel, oblique_plane(id));
}
