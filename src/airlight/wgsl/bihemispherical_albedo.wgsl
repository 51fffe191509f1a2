// How much of the light from all around a surface reflects, over all directions together: the twin of
// maths/reflection.py, which says where the numbers come from.

fn bihemispherical_albedo(base_color: vec3f, metallic: f32, roughness: f32, specular: f32) -> vec3f {
    let f0 = mix(vec3f(0.04 * specular), base_color, metallic);
    let f90 = saturate(50.0 * max(f0.x, max(f0.y, f0.z)));

    // What the coat reflects is lost to the diffuse part.
    let lost = f0 + (vec3f(f90) - f0) * 0.003686;

    // GGX's own share, by its roughness.
    let r = roughness;
    let of_f0 = (((1.491485 * r - 2.701481) * r + 0.713008) * r - 0.047394) * r + 0.952567;
    let of_f90 = (((-0.219233 * r + 0.545499) * r - 0.411123) * r + 0.040300) * r + 0.047105;
    return base_color * (1.0 - metallic) * (vec3f(1.0) - lost) + f0 * of_f0 + vec3f(f90 * of_f90);
}
