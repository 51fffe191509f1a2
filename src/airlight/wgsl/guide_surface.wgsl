// Rays of a surface's points by the cosine about `facing`, its normal, beside those that patches lead (light_guide.wgsl).

// Towards a cone about `along`, eased by the sine of half its angle; over pi it is the density of those rays, sr^-1.
fn patch_cosine(along: vec3f, sine: f32, facing: vec3f) -> f32 {
    return saturate((dot(facing, along) + sine) / (1.0 + sine));
}
