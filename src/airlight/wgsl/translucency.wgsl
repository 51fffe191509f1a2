// Surfaces that light passes straight through: blended ones and thin glass; twin of maths/translucency.py.

// The share of a surface that is there, of its alpha.
fn coverage(alpha: f32, is_blended: bool) -> f32 {
    return select(1.0, saturate(alpha), is_blended);
}

// What passes, rgb: between what is there, and through glass what it does not mirror, tinted.
fn passed_share(base: vec3f, coverage: f32, transmission: f32, mirrored: f32) -> vec3f {
    return 1.0 - coverage + coverage * transmission * (1.0 - mirrored) * saturate(base);
}

// What a dielectric mirrors at an angle, as `fresnel` of surface_reflection.
fn dielectric_fresnel(f0: f32, cosine: f32) -> f32 {
    return f0 + (saturate(50.0 * f0) - f0) * pow(saturate(1.0 - cosine), 5.0);
}

fn mean_channel(color: vec3f) -> f32 {
    return (color.r + color.g + color.b) / 3.0;
}

// A number from 0 to 1 for a texel, spread evenly among neighbours (Jimenez2014, interleaved gradient noise); `plane`
// tells surfaces apart that lie one behind the other.
fn chance(texel: vec2f, plane: f32) -> f32 {
    return fract(52.9829189 * fract(dot(texel, vec2f(0.06711056, 0.00583715))) + fract(7.31 * plane));
}
