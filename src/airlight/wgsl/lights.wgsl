// Lights without extent. The including pass declares the struct LightData.

const LIGHT_DIRECTIONAL = 0u;
const LIGHT_POINT = 1u;
const LIGHT_SPOT = 2u;

struct Incoming {
    to_light: vec3f,    // unit
    irradiance: vec3f,  // W m^-2 at normal incidence, unshadowed
    distance: f32,      // m
}

// The spot's fade between its half angles: smoothstep of the cosine.
fn spot_fade(light: LightData, direction: vec3f) -> f32 {
    let c = dot(direction, light.direction);
    return smoothstep(light.cos_outer, max(light.cos_inner, light.cos_outer + 1e-4), c);
}

fn incoming(light: LightData, position: vec3f) -> Incoming {
    var result: Incoming;
    if (light.kind == LIGHT_DIRECTIONAL) {
        result.to_light = -light.direction;
        result.irradiance = light.color;
        result.distance = 1e30;
        return result;
    }
    let delta = light.position - position;
    let squared = max(dot(delta, delta), 1e-8);
    result.distance = sqrt(squared);
    result.to_light = delta / result.distance;
    result.irradiance = light.color / squared;
    if (light.kind == LIGHT_SPOT) {
        result.irradiance *= spot_fade(light, -result.to_light);
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
