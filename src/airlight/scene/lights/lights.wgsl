// Lights as points: those without extent, and samples of those with one. The including pass
// declares the struct LightData.
//! use light_kinds

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

fn incoming(light: LightData, position: vec3f) -> Incoming {
    var result: Incoming;
    if (light.kind == LIGHT_DIRECTIONAL) {
        result.to_light = -light.direction;
        result.irradiance = light.color;
        result.distance = 1e30;
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
