// GGX as a linearly transformed cosine (Heitz2016); twin of maths/area_light.py. The including pass binds
// `cosines`, the table that maths/cosines_fit.py makes: two vec4f an entry.

const COSINE_SIDE = 32u;

struct SpecularCosine {
    inverse: mat3x3f,   // in the frame of normal and view
    albedos: vec2f,     // of the reflectance at normal incidence, and at grazing
}

fn cosine_entry(row: u32, column: u32, part: u32) -> vec4f {
    return cosines[2u * (row * COSINE_SIDE + column) + part];
}

fn specular_cosine(view_cosine: f32, alpha: f32) -> SpecularCosine {
    let last = f32(COSINE_SIDE - 1u);
    let row = sqrt(saturate(alpha)) * last;
    let column = sqrt(1.0 - saturate(view_cosine)) * last;
    let r = min(u32(row), COSINE_SIDE - 2u);
    let c = min(u32(column), COSINE_SIDE - 2u);
    let v = row - f32(r);
    let u = column - f32(c);
    // Bilinear between four entries of the table: the inverse's numbers, then the albedos.
    let m = mix(mix(cosine_entry(r, c, 0u), cosine_entry(r, c + 1u, 0u), u),
        mix(cosine_entry(r + 1u, c, 0u), cosine_entry(r + 1u, c + 1u, 0u), u), v);
    let albedos = mix(mix(cosine_entry(r, c, 1u), cosine_entry(r, c + 1u, 1u), u),
        mix(cosine_entry(r + 1u, c, 1u), cosine_entry(r + 1u, c + 1u, 1u), u), v);
    return SpecularCosine(mat3x3f(m.x, 0.0, m.z, 0.0, 1.0, 0.0, m.y, 0.0, m.w), albedos.xy);
}
