// Samples of lights with extent as media near them see them: flat parts as rectangles, bodies as balls. The including
// pass declares LightData, and with the media HAS_SIZED_LIGHTS (media/media_slots.py).
//! use light_kinds
//! use light_sizes

// Whether a light is seen as what it is as large as, and not as a point.
fn has_size(light: LightData) -> bool {
    return HAS_SIZED_LIGHTS && light.kind == LIGHT_SAMPLE && light.size_x > 0.0;
}

fn is_ball(light: LightData) -> bool {
    return light.size_y == 0.0;
}

// A point `away` from a rectangle, along its sides and above it.
fn place_above(light: LightData, away: vec3f) -> vec3f {
    let across = cross(light.direction, light.tangent);
    return vec3f(dot(away, light.tangent), dot(away, across), dot(away, light.direction));
}

// The irradiance, over the light's color, that media get: its radiance by its solid angle, m^-2.
fn sized_share(light: LightData, away: vec3f) -> f32 {
    if (is_ball(light)) {
        return (0.25 * light.shape_x + light.shape_y) * ball_share(length(away), light.size_x);
    }
    let half = vec2f(light.size_x, light.size_y);
    return light.shape_x * rectangle_angle(place_above(light, away), half) / (4.0 * half.x * half.y);
}

// How far away, m, it is for what attenuates its light.
fn sized_reach(light: LightData, away: vec3f) -> f32 {
    if (is_ball(light)) {
        return ball_reach(length(away), light.size_x);
    }
    return rectangle_reach(place_above(light, away), vec2f(light.size_x, light.size_y));
}

// The mean direction in which its light travels, and how much less sharply media scatter it for coming from all of it.
fn sized_directions(light: LightData, away: vec3f) -> vec4f {
    if (is_ball(light)) {
        let angle = 3.14159265 * light.size_x * light.size_x * ball_share(length(away), light.size_x);
        return vec4f(normalize(away), sharpness_over(angle));
    }
    let half = vec2f(light.size_x, light.size_y);
    let at = place_above(light, away);
    let angle = rectangle_angle(at, half);
    let from_to = rectangle_direction(at, half, angle);
    let across = cross(light.direction, light.tangent);
    return vec4f(from_to.x * light.tangent + from_to.y * across + from_to.z * light.direction, sharpness_over(angle));
}
