// What lights are as large as, from a point near them. Twins, and where the numbers come from: maths/light_sizes.py.

const FAR_AWAY = 400.0;     // squares of half diagonals, from where on all of a rectangle is as far away

// Solid angle, sr, of a rectangle of sides 2 half at the origin, from a point along both sides and above it, m; none
// from below.
fn rectangle_angle(at: vec3f, half: vec2f) -> f32 {
    let h = at.z;
    let squared = dot(at, at);
    if (squared > FAR_AWAY * dot(half, half)) {
        return 4.0 * half.x * half.y * max(h, 0.0) * inverseSqrt(squared) / squared;
    }
    // Of each corner, that of the rectangle from the foot of the perpendicular to it.
    let x = vec4f(half.x - at.x, half.x + at.x, half.x - at.x, half.x + at.x);
    let y = vec4f(half.y - at.y, half.y - at.y, half.y + at.y, half.y + at.y);
    let corners = atan(x * y / (max(h, 1e-12) * sqrt(x * x + y * y + h * h)));
    return select(0.0, max(dot(corners, vec4f(1.0)), 0.0), h > 0.0);
}

// How far away, m, it is for what attenuates its light: between its nearest point and farther ones.
fn rectangle_reach(at: vec3f, half: vec2f) -> f32 {
    let beside = vec3f(max(abs(at.xy) - half, vec2f(0.0)), at.z);
    let near = length(beside);
    let far = sqrt(dot(at, at) + 2.5464791 * half.x * half.y);
    return 2.0 * near * far / (near + far);
}

// Solid angle of a ball over the area of its disk, m^-2; from within it, as from its surface.
fn ball_share(distance: f32, radius: f32) -> f32 {
    let d = max(distance, radius);
    let share = radius / d;
    return 2.0 / (d * d * (1.0 + sqrt(max(1.0 - share * share, 0.0))));
}

// How far away, m, it is for what attenuates its light.
fn ball_reach(distance: f32, radius: f32) -> f32 {
    let near = max(distance - radius, 0.0);
    return pow(near, 0.8333333) * pow(distance + radius, 0.1666667);
}

// What the g of a phase function is multiplied by, for its mean over the directions of a light seen under `angle`, sr.
fn sharpness_over(angle: f32) -> f32 {
    let cosine = 1.0 - angle * 0.079577472;
    return cosine * cosine;
}

// The mean direction of a rectangle's light at a point that sees it under `angle`, sr.
fn rectangle_direction(at: vec3f, half: vec2f, angle: f32) -> vec3f {
    let nearest = clamp(at.xy, -half, half);
    let share = saturate(angle * 0.15915494);
    return normalize(vec3f(at.xy - share * nearest, max(at.z, 1e-9)));
}
