// Directions on a square, [-1, 1]^2; see maths/octahedron.py.

fn octahedron_sign(p: vec2f) -> vec2f {
    return select(vec2f(1.0), vec2f(-1.0), p < vec2f(0.0));
}

fn octahedron_encode(direction: vec3f) -> vec2f {
    let p = direction.xy / dot(abs(direction), vec3f(1.0));
    let folded = (1.0 - abs(p.yx)) * octahedron_sign(p);
    return select(p, folded, direction.z < 0.0);
}

fn octahedron_decode(square: vec2f) -> vec3f {
    return normalize(octahedron_point(square));
}

// On the octahedron itself: the direction, but not of unit length.
fn octahedron_point(square: vec2f) -> vec3f {
    let z = 1.0 - abs(square.x) - abs(square.y);
    let folded = (1.0 - abs(square.yx)) * octahedron_sign(square);
    return vec3f(select(square, folded, z < 0.0), z);
}

fn octahedron_pack16(direction: vec3f) -> u32 {
    return pack2x16snorm(octahedron_encode(direction));
}

// The cell reached by a step of one cell along u or v; the square's edges are sewn to themselves.
fn octahedron_neighbour(cell: vec2i, step: vec2i, count: i32) -> vec2i {
    let c = cell + step;
    let outside = (c < vec2i(0)) | (c >= vec2i(count));
    let mirrored = select(c, count - 1 - c, outside.yx);
    return clamp(mirrored, vec2i(0), vec2i(count - 1));
}
