// Directions towards lit patches, and where rays go there: the twin of maths/light_guide.py.
//! use sampling

const RARE = 0.03;
const COMMON = 0.25;
const HALVING = 0.3;
const MOST_GUIDED = 0.5;

fn cone_direction(axis: vec3f, height: f32, numbers: vec2f) -> vec3f {
    let drop = numbers.x * height;
    let radius = sqrt(max(drop * (2.0 - drop), 0.0));
    let angle = 6.2831853 * numbers.y;
    return orthonormal_frame(axis) * vec3f(radius * cos(angle), radius * sin(angle), 1.0 - drop);
}

fn is_guided(found: f32) -> bool {
    return found < COMMON;
}

fn guided_share(found: f32) -> f32 {
    return MOST_GUIDED / (1.0 + found / HALVING);
}
