// The transmittance of a homogeneous medium around the solved one on light's path to a point; see
// pop/medium/surrounding.py, and transmittance_in_box in maths/medium.py. The including pass binds `params` (MediumParams).
//! use medium

// Of light that travelled a `distance`, m; all in the frame of the solved medium.
fn passed_surrounding(point: vec3f, travel: vec3f, distance: f32) -> vec3f {
    if (all(params.surrounding_sigma_t == vec3f(0.0))) {
        return vec3f(1.0);
    }
    let origin = (params.surrounding_from_medium * vec4f(point, 1.0)).xyz;
    let back = -(params.surrounding_from_medium * vec4f(travel, 0.0)).xyz;
    let inside = ray_box_interval(origin, back, vec3f(0.0), vec3f(1.0));
    let path = max(0.0, min(inside.y, distance) - max(inside.x, 0.0));
    return exp(-params.surrounding_sigma_t * path);
}
