// What arrives of a light where its shadow map is unsure: a ray decides. The including pass binds what rays need.
//! use ray_start
//! use rays

override ARE_PIXELS: bool = false;      // the points, else what rays met

// `lit`: the share that the map says.
fn arriving_share(lit: f32, p: vec3f, n: vec3f, in: Incoming) -> f32 {
    if (lit <= 0.0 || lit >= 1.0) {
        return lit;
    }
    let raised = select(params.ray_start, RAISED * distance(p, params.eye), ARE_PIXELS);
    return select(1.0, 0.0, any_hit(p + raised * n, in.to_light, 0.0, in.distance));
}
