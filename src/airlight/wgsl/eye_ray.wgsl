// Rays through pixels. The including pass declares RayParams.

const EYE_RAY_FAR = 1e9;    // m, where there is no surface

struct EyeRay {
    direction: vec3f,   // unit
    distance: f32,      // m, to the surface
}

// Through the pixel's centre, not normalised: one metre deep. Depth 0 is at infinity, so the
// matrix gives a direction, and no large positions are subtracted.
fn pixel_direction(world_from_clip: mat4x4f, pixel: vec2f, size: vec2f) -> vec3f {
    let ndc = vec2f(pixel.x / size.x, 1.0 - pixel.y / size.y) * 2.0 - 1.0;
    return (world_from_clip * vec4f(ndc, 0.0, 1.0)).xyz;
}

// Along the pixel's ray to a reversed infinite depth.
fn pixel_distance(world_from_clip: mat4x4f, direction: vec3f, depth: f32) -> f32 {
    if (depth <= 0.0) {
        return EYE_RAY_FAR;
    }
    return min(length(direction) / (world_from_clip[2].w * depth), EYE_RAY_FAR);
}

// The index-th pixel of a texel `scale` pixels wide, 1, 2 or 4: drivers divide integers slowly.
fn texel_pixel(index: u32, scale: u32) -> vec2u {
    return vec2u(index & (scale - 1u), index >> (scale >> 1u));
}

// The ray of a texel of a reduced image; `picked` as from media/rays.wgsl.
fn picked_ray(rays: RayParams, texel: vec2u, picked: vec2f) -> EyeRay {
    let inside = texel_pixel(u32(picked.y), rays.scale);
    let pixel = vec2f(min(texel * rays.scale + inside, rays.size - 1u)) + 0.5;
    let direction = pixel_direction(rays.world_from_clip, pixel, vec2f(rays.size));
    return EyeRay(normalize(direction), picked.x);
}
