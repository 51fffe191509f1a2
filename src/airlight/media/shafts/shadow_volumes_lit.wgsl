// Single scattering of all lights towards the eye, without shadows.
//! use eye_ray
//! use lit_interval
//! use light_reach

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let centre = position.xy * f32(rays.scale);
    let direction = normalize(pixel_direction(rays.world_from_clip, centre, vec2f(rays.size)));
    let reach = textureLoad(picked, vec2i(position.xy), 0).x;
    let hull = visible_interval(media_enter(rays.eye, direction, reach));
    // F of each light over the stretch that it reaches, as if nothing stood before it.
    var sum = vec3f(0.0);
    for (var i = 0u; i < params.light_count; i++) {
        let light = row_of_lights(i);
        let span = light_span(light, rays.eye, direction, hull);
        if (span.x < span.y && any(light.color > vec3f(0.0))) {
            prepare_lit_intervals(light, rays.eye, direction);
            sum += lit_interval(light, i, rays.eye, direction, span.x, span.y);
        }
    }
    return vec4f(sum, 1.0);
}
