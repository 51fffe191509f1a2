// What a light brings into a cell. The including pass binds the lights' shadow maps (parallel_views,
// parallel_shadows, local_views, local_shadows, shadow_compare) and what `lights` needs.
//! use lights
//! use map_visibility
//! use sized_light

// The mean of 1/|x|^2 over a ball of radius R whose centre is D away from the light, m^-2: finite
// where the light is in the cell.
fn mean_inverse_square(D: f32, R: f32) -> f32 {
    let d = max(D, 1e-3 * R);
    let q = R * R / (d * d);
    if (q < 0.09) {
        return (1.0 + q * (0.2 + q * (0.0857143 + q * 0.0476190))) / (d * d);
    }
    let inside = max(abs(R - d), 1e-6 * R);
    return 1.5 / (R * R * R) * (R + (R * R - d * d) / (2.0 * d) * log((R + d) / inside));
}

fn ball_radius(size: vec3f) -> f32 {
    return 0.6203505 * pow(size.x * size.y * size.z, 0.3333333);
}

// What the mean irradiance over a ball of radius R is of a local light's at its centre, `distance` away. One of known
// size is as bright all around as its solid angle is.
fn gain_in_ball(light: LightData, distance: f32, R: f32) -> f32 {
    return select(distance * distance * mean_inverse_square(distance, R), 1.0, has_size(light));
}

// How much of a light's shadow map p is lit in.
fn lit_point(light: LightData, to_light: vec3f, p: vec3f) -> f32 {
    let index = view_of(light, to_light);
    let is_parallel = light.kind == LIGHT_DIRECTIONAL;
    var clip: vec4f;
    if (is_parallel) {
        clip = row_of_parallel_views(index).clip_from_world * vec4f(p, 1.0);
    } else {
        clip = row_of_local_views(index).clip_from_world * vec4f(p, 1.0);
    }
    if (clip.w <= 0.0) {
        return 1.0;
    }
    let coordinates = map_coordinates(clip.xyz / clip.w);
    if (is_parallel) {
        return map_visibility(parallel_shadows, shadow_compare, index, coordinates);
    }
    return map_visibility(local_shadows, shadow_compare, index, coordinates);
}
