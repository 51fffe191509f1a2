// How oblique surfaces are to the cells of a lattice.

// From where on a surface is oblique to an axis of the cells: cosines of 8 and 3 degrees between its normal and that.
const OBLIQUE = vec2f(0.9903, 0.9986);

// How oblique a surface of normal n is to the faces of cells: 1 up to the first of two cosines to the nearest axis,
// 0 from the second on. A point of a medium (n = 0) is not.
fn obliqueness(n: vec3f, cosines: vec2f) -> f32 {
    let along = max(abs(n.x), max(abs(n.y), abs(n.z)));
    return select(0.0, 1.0 - smoothstep(cosines.x, cosines.y, along), along > 0.0);
}
