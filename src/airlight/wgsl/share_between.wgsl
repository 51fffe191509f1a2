// The share that a face's values around its four corners have of what can count there, at most. `most`: of one and of the
// other cell that it lies between; where a wall ends at another one, the corners there have a part of it.
// Twin: maths.lattice26_walls.share_between.

const LEAST = 1e-3;        // walls that touch leave nothing between them

fn share_between(values: vec4f, most: array<vec4f, 2>) -> f32 {
    let one = dot(min(values, most[0]), vec4f(1.0)) / max(dot(most[0], vec4f(1.0)), LEAST);
    let other = dot(min(values, most[1]), vec4f(1.0)) / max(dot(most[1], vec4f(1.0)), LEAST);
    return max(0.25 * dot(values, vec4f(1.0)), max(one, other));
}
