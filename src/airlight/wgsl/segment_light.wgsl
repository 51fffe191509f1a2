// What a long thin part of a light sends from a surface to the eye. The including pass declares SampleData and
// the override HAS_GLOSS.
//! use area_light
//! use area_shadow

// W m^-2 sr^-1 for a sample of intensity 1; `normal`: the sample's, along the axes of its views, as all of `at` is.
// `into`: from those axes to the lobe's cosine; `albedos`: of the lobe. Without what stands in between.
fn segment_light(sample: SampleData, normal: vec3f, at: Viewed, r: Reflector, into: mat3x3f, albedos: vec2f,
    is_glossy: bool) -> vec3f {
    let a = sample.middle - sample.half - at.own;
    let b = sample.middle + sample.half - at.own;
    // What faces one way sends by the cosine about its normal, across the segment; the rest as a tube, or beads.
    let along = normalize(sample.half);
    let across = normalize(normal - dot(normal, along) * along + vec3f(1e-12));
    let apart = dot(a, along) * along - a;
    let front = dot(across, apart) * inverseSqrt(max(dot(apart, apart), 1e-12));
    let sent = vec2f(sample.front * max(front, 0.0) + sample.even * sample.tube * (4.0 / PI),
        sample.even * (1.0 - sample.tube)) / (2.0 * length(sample.half));
    let irradiance = dot(segment_irradiance(a, b, at.n, sample.width), sent);
    if (!HAS_GLOSS) {
        return r.diffuse * (irradiance / PI);
    }
    // Fresnel towards the middle divides the light between coat and paint, as of other emitters.
    let f = fresnel(r.f0, saturate(dot(at.v, normalize(at.v + normalize(sample.middle - at.own)))));
    let matt = (vec3f(1.0) - f) * r.diffuse * (irradiance / PI);
    if (!is_glossy) {
        return matt;
    }
    // Gloss is that of a strip as wide, which faces the point.
    let side = normalize(cross(a, b) + vec3f(1e-20)) * sample.width;
    var strip = outline_from(into * (a - side));
    strip = outline_to(strip, into * (b - side));
    strip = outline_to(strip, into * (b + side));
    strip = outline_to(strip, into * (a + side));
    strip = outline_to(strip, into * (a - side));
    let share = outline_irradiance(strip) / PI;
    let f90 = saturate(max(r.f0.x, max(r.f0.y, r.f0.z)) * 50.0);
    let gloss = r.f0 * albedos.x + vec3f(f90 * albedos.y);
    return matt + gloss * (share * (sent.x + sent.y) / (2.0 * sample.width));
}
