// What arrives of a light where its shadow map is unsure: a ray decides. The including pass binds what rays need.
//! use rays

override SHADOW_RAISED: f32 = 0.0;      // of the distance to the eye: where rays start above their surface

// `lit`: the share that the map says.
fn arriving_share(lit: f32, p: vec3f, n: vec3f, in: Incoming) -> f32 {
    if (lit <= 0.0 || lit >= 1.0) {
        return lit;
    }
    let raised = SHADOW_RAISED * distance(p, params.eye) + params.ray_start;
    return select(1.0, 0.0, any_hit(p + raised * n, in.to_light, 0.0, in.distance));
}
