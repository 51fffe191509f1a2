// Light that media only scatter forwards; see maths/forward_beams.py.
//! use medium

const SPREAD = 0.41;
const BACK = 0.58;
const INSIDE = 0.8;

// T' - T, by the optical depths of the reduced media and those that the true media have beside them.
fn passed_forwards(reduced: vec3f, forward: vec3f) -> vec3f {
    return exp(-reduced) * (1.0 - exp(-forward));
}

// (deviation, back), m, of light that a medium deflects between `near` and `far` before a point.
fn slant(near: f32, far: f32, g: f32) -> vec2f {
    let reach = sqrt(near * near + near * far + far * far);
    return vec2f(SPREAD * sqrt(2.0 * max(1.0 - g, 1e-4)), BACK) * reach;
}

// (near, far, aside), m: where a box about the origin lies on the nearest parallel of a path that goes well through it.
fn span_beside(size: vec3f, origin: vec3f, towards: vec3f) -> vec3f {
    let half = 0.5 * INSIDE * size;
    var t = max(-dot(origin, towards), 0.0);
    var nearest = vec3f(0.0);
    for (var i = 0u; i < 3u; i++) {
        nearest = clamp(origin + t * towards, -half, half);
        t = max(dot(nearest - origin, towards), 0.0);
    }
    let offset = nearest - (origin + t * towards);
    let aside = offset - dot(offset, towards) * towards;
    let span = ray_box_interval(origin + aside, towards, -0.5 * size, 0.5 * size);
    return vec3f(max(span.x, 0.0), span.y, length(aside));
}
