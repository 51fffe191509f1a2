// Directions that a smooth surface mirrors the eye's ray into, by chance; twin of maths/ggx_sampling.py. In axes whose
// third is the normal.
//! use surface_reflection

// A microfacet's normal, distributed as those that the eye sees (Heitz2018b).
fn visible_normal(v: vec3f, alpha: f32, numbers: vec2f) -> vec3f {
    let stretched = normalize(vec3f(alpha * v.xy, v.z));
    let flat = dot(stretched.xy, stretched.xy);
    var across = vec3f(1.0, 0.0, 0.0);
    if (flat > 1e-12) {
        across = vec3f(-stretched.y, stretched.x, 0.0) * inverseSqrt(flat);
    }
    let radius = sqrt(numbers.x);
    let a = radius * cos(2.0 * PI * numbers.y);
    let s = 0.5 * (1.0 + stretched.z);
    let b = mix(sqrt(max(1.0 - a * a, 0.0)), radius * sin(2.0 * PI * numbers.y), s);
    let h = a * across + b * cross(stretched, across) + sqrt(max(1.0 - a * a - b * b, 0.0)) * stretched;
    return normalize(vec3f(alpha * h.xy, max(h.z, 1e-6)));
}

// Of directions mirrored at those normals, sr^-1.
fn mirrored_density(n_h: f32, n_v: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    return ggx_distribution(n_h, alpha) / (2.0 * (n_v + sqrt(a2 + (1.0 - a2) * n_v * n_v)));
}

// The BRDF without Fresnel's term, times the cosine to the light, sr^-1.
fn mirrored_gloss(n_h: f32, n_l: f32, n_v: f32, alpha: f32) -> f32 {
    return ggx_distribution(n_h, alpha) * smith_visibility(n_l, n_v, alpha) * n_l;
}
