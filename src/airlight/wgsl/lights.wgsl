// Lights as points: those without extent, and samples of those with one. The including pass declares the struct LightData.

const LIGHT_DIRECTIONAL = 0u;
const LIGHT_POINT = 1u;
const LIGHT_SPOT = 2u;
const LIGHT_SAMPLE = 3u;    // it and spots send more in some directions than in others

struct Incoming {
    to_light: vec3f,    // unit
    irradiance: vec3f,  // W m^-2 at normal incidence, unshadowed
    distance: f32,      // m
}

// What is sent along `direction`, of what is sent along the light's: a spot's fade between its half
// angles is the smoothstep of the cosine, a sample of a surface sends by the cosine.
fn sent_share(light: LightData, direction: vec3f) -> f32 {
    let c = dot(direction, light.direction);
    if (light.kind == LIGHT_SAMPLE) {
        return light.cos_inner * max(c, 0.0) + light.cos_outer;
    }
    return smoothstep(light.cos_outer, max(light.cos_inner, light.cos_outer + 1e-4), c);
}

// The distance, m, at which a point would be as bright as a light `distance` from a ray: what
// comes of a surface is nowhere as bright as near a point.
fn softened(light: LightData, distance: f32) -> f32 {
    return select(distance, sqrt(distance * distance + light.nearest), light.kind == LIGHT_SAMPLE);
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
    let squared = max(dot(delta, delta), light.nearest);
    result.distance = sqrt(squared);
    result.to_light = delta / result.distance;
    result.irradiance = light.color / squared;
    if (light.kind >= LIGHT_SPOT) {
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
