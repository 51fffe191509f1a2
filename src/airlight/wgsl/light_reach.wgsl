// What of an eye ray a light can reach. The including pass declares LightData.
//! use lights
//! use medium

fn light_span(light: LightData, origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f {
    if (light.kind != LIGHT_SPOT) {
        return hull;
    }
    let cone = ray_cone_interval(
        origin, direction, light.position, light.direction, light.cos_outer);
    return vec2f(max(hull.x, cone.x), min(hull.y, cone.y));
}
