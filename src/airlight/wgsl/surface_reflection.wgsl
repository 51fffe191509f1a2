// Lambert + GGX, metallic-roughness (glTF 2.0, appendix B).

const PI = 3.14159265;

struct Reflector {
    diffuse: vec3f,     // diffuse albedo
    f0: vec3f,          // reflectance at normal incidence
    alpha: f32,         // roughness squared
}

fn reflector(base_color: vec3f, metallic: f32, roughness: f32, specular: f32) -> Reflector {
    var r: Reflector;
    r.diffuse = base_color * (1.0 - metallic);
    r.f0 = mix(vec3f(0.04 * specular), base_color, metallic);
    r.alpha = max(roughness * roughness, 0.002);
    return r;
}

// A material with no specular part at all (specular = 0, not metallic) stays pure Lambert.
fn fresnel(f0: vec3f, cosine: f32) -> vec3f {
    let f90 = saturate(max(f0.x, max(f0.y, f0.z)) * 50.0);
    return f0 + (vec3f(f90) - f0) * pow(saturate(1.0 - cosine), 5.0);
}

fn ggx_distribution(n_h: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let d = n_h * n_h * (a2 - 1.0) + 1.0;
    return a2 / (PI * d * d);
}

// Smith's masking and shadowing over 4 n.l n.v (Heitz2014, height-correlated).
fn smith_visibility(n_l: f32, n_v: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let l = n_v * sqrt(n_l * n_l * (1.0 - a2) + a2);
    let v = n_l * sqrt(n_v * n_v * (1.0 - a2) + a2);
    return 0.5 / max(l + v, 1e-6);
}

// f(l, v), sr^-1.
fn reflection(r: Reflector, n: vec3f, l: vec3f, v: vec3f) -> vec3f {
    let h = normalize(l + v);
    let n_l = saturate(dot(n, l));
    let n_v = max(dot(n, v), 1e-4);
    let f = fresnel(r.f0, saturate(dot(v, h)));
    let specular = f * ggx_distribution(saturate(dot(n, h)), r.alpha)
        * smith_visibility(n_l, n_v, r.alpha);
    return matt_reflection(r, l, v) + specular;
}

// What of it is matt: light that passes into the surface and comes out again.
fn matt_reflection(r: Reflector, l: vec3f, v: vec3f) -> vec3f {
    let f = fresnel(r.f0, saturate(dot(v, normalize(l + v))));
    return (vec3f(1.0) - f) * r.diffuse / PI;
}

// Share of light from all around that the specular part reflects (Karis2014, analytic fit).
fn specular_albedo(r: Reflector, n_v: f32) -> vec3f {
    let roughness = sqrt(r.alpha);
    let c = vec4f(-1.0, -0.0275, -0.572, 0.022) * roughness + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a004 = min(c.x * c.x, exp2(-9.28 * n_v)) * c.x + c.y;
    let scale_bias = vec2f(-1.04, 1.04) * a004 + c.zw;
    let f90 = saturate(max(r.f0.x, max(r.f0.y, r.f0.z)) * 50.0);
    return r.f0 * scale_bias.x + vec3f(scale_bias.y * f90);
}

// How much of what a surface mirrors deserves a ray: none where it is rough or hardly mirrors.
fn glossy_share(specular_albedo: vec3f, roughness: f32) -> f32 {
    let gain = max(specular_albedo.x, max(specular_albedo.y, specular_albedo.z));
    return smoothstep(0.03, 0.08, gain * (1.0 - roughness));
}

// Of a coat alone, seen at a cosine to its normal.
fn coat_share(f0: f32, alpha: f32, n_v: f32) -> f32 {
    let coat = Reflector(vec3f(0.0), vec3f(f0), alpha);
    return glossy_share(specular_albedo(coat, max(n_v, 1e-4)), sqrt(alpha));
}
