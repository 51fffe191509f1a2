// The transmittance of homogeneous media to the surface of a pixel, in closed form.
//! use media
//! use eye_ray

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let direction = pixel_direction(rays.world_from_clip, position.xy, vec2f(rays.size));
    let reach = pixel_distance(rays.world_from_clip, direction,
        textureLoad(depth, vec2i(position.xy), 0));
    return vec4f(exp(-media_optical_depth(rays.eye, normalize(direction), 0.0, reach)), 1.0);
}
