// The plane of the surface that an eye ray ends at, before which the light of cells is read.

// How far before a surface oblique to the cells light is read, cells: farther than any of the eight that are read
// there can lie behind it.
const CELLS_BEFORE = 1.5;
// Cosines to the ray from which on a plane through neighbouring rays' ends is a surface: at an edge it is not.
const EDGE = vec2f(0.1, 0.25);

// Its normal, towards the eye, or 0 where there is no surface, and how far before it light is to be read, m.
struct EndPlane { point: vec3f, normal: vec3f, before: f32 }

// The normal of a plane, towards the eye, and how far it is a surface, 0 to 1. The plane goes through the end of a ray,
// `distance` away along `direction`, and through those of its neighbours, `right` and `down` of there; rays that end at
// nothing are `farthest` long. A plane along the ray, or so far off, has the ray's points on either side by
// rounding: it has no normal, and so moves none.
fn end_normal(direction: vec3f, distance: f32, farthest: f32, right: vec3f, down: vec3f) -> vec4f {
    let across = cross(right, down);
    let length_across = length(across);
    let facing = dot(across, direction) / max(length_across, 1e-20);
    let share = select(0.0, smoothstep(EDGE.x, EDGE.y, abs(facing)), distance < farthest);
    let n = across * (-sign(facing) / max(length_across, 1e-20));
    return vec4f(select(vec3f(0.0), n, share > 0.0), share);
}

// Where light is read for a point of the ray: no nearer to an oblique plane than its cells reach.
fn moved_before(plane: EndPlane, p: vec3f) -> vec3f {
    return p + max(plane.before - dot(p - plane.point, plane.normal), 0.0) * plane.normal;
}
