// The piece of an eye ray that a light can reach: what lies in its cone, if it has one. The including pass declares
// LightData.
//! use light_kinds
//! use medium

fn light_span(light: LightData, origin: vec3f, direction: vec3f, hull: vec2f) -> vec2f {
    if (light.kind != LIGHT_SPOT) {
        return hull;
    }
    let cone = ray_cone_interval(
        origin, direction, light.position, light.direction, light.shape_y);
    return vec2f(max(hull.x, cone.x), min(hull.y, cone.y));
}
