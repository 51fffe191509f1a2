// Lights as points: those without extent, and samples of those with one. The including pass
// declares the struct LightData.
//! use light_kinds
//! use sized_light

struct Incoming {
    to_light: vec3f,    // unit
    irradiance: vec3f,  // W m^-2 at normal incidence, unshadowed
    distance: f32,      // m
}

// The share of its strength that a light which sends by direction sends along `direction`.
fn sent_share(light: LightData, direction: vec3f) -> f32 {
    return share_at(light.kind, dot(direction, light.direction), vec2f(light.shape_x, light.shape_y));
}

// The distance, m, at which a point would be as bright as a light `distance` from a ray: what
// comes of a surface is nowhere as bright as near a point.
fn softened(light: LightData, distance: f32) -> f32 {
    return select(distance, sqrt(distance * distance + light.nearest), light.kind == LIGHT_SAMPLE);
}

// A local light as media see it.
struct SeenLight {
    gain: f32,      // what they get, over its color by the square of the softened distance
    reach: f32,     // m, that attenuates it
    mu: f32,        // cosine of the angle by which what goes to the eye is scattered, in the mean
    sharpness: f32, // what g is multiplied by, as light comes from many directions
}

// From a point `away` from it, towards `eye`; `squared` and `mu` as of a softened point. A part of known size sends
// its radiance from its solid angle, any other as much as a point in all of space.
fn seen_light(light: LightData, away: vec3f, eye: vec3f, squared: f32, mu: f32) -> SeenLight {
    if (has_size(light)) {
        let directions = sized_directions(light, away);
        return SeenLight(squared * sized_share(light, away), sized_reach(light, away),
            dot(directions.xyz, eye), directions.w);
    }
    var gain = 1.0;
    if (sends_by_direction(light.kind)) {
        gain = sent_share(light, normalize(away));
        gain *= select(1.0, softened_gain(light.nearest, squared), light.kind == LIGHT_SAMPLE);
    }
    return SeenLight(gain, sqrt(squared), mu, 1.0);
}

fn incoming(light: LightData, position: vec3f) -> Incoming {
    var result: Incoming;
    if (light.kind == LIGHT_DIRECTIONAL) {
        result.to_light = -light.direction;
        result.irradiance = light.color;
        result.distance = 1e30;
        return result;
    }
    // Near by all of a part is seen.
    if (has_size(light)) {
        let away = position - light.position;
        result.to_light = -normalize(away);
        result.irradiance = light.color * sized_share(light, away);
        result.distance = sized_reach(light, away);
        return result;
    }
    // I / r^2, r^2 no less than `nearest`: no point is lit infinitely.
    let delta = light.position - position;
    let squared = max(dot(delta, delta), light.nearest);
    result.distance = sqrt(squared);
    result.to_light = delta / result.distance;
    result.irradiance = light.color / squared;
    if (sends_by_direction(light.kind)) {
        result.irradiance *= sent_share(light, -result.to_light);
    }
    return result;
}

// Which face of a cube of views (+x -x +y -y +z -z) a direction falls on.
fn cube_face(direction: vec3f) -> u32 {
    let a = abs(direction);
    if (a.x >= a.y && a.x >= a.z) { return select(1u, 0u, direction.x > 0.0); }
    if (a.y >= a.z) { return select(3u, 2u, direction.y > 0.0); }
    return select(5u, 4u, direction.z > 0.0);
}

fn view_of(light: LightData, to_light: vec3f) -> u32 {
    return light.first_view + select(0u, cube_face(-to_light), light.view_count == 6u);
}
