// Spherical harmonics and two-band intensities; order, signs and sources in maths/sh.py.

const SH_Y0 = 0.28209479177387814;
const SH_Y1 = 0.4886025119029199;
const SH_Y2_XY = 1.0925484305920792;
const SH_Y2_Z = 0.31539156525252005;
const SH_Y2_X = 0.5462742152960396;
const SH_PI = 3.141592653589793;

// I(w) = a + b.w of a two-band state (a, bx, by, bz), W/sr; not clamped.
fn intensity(state: vec4f, direction: vec3f) -> f32 {
    return state.x + dot(state.yzw, direction);
}

// The two-band clamped cosine lobe of total power `power_w` about a unit normal.
fn cosine_lobe(normal: vec3f, power_w: f32) -> vec4f {
    return vec4f(1.0, 2.0 * normal) * (power_w / (4.0 * SH_PI));
}

// Irradiance, W m^-2, on a unit normal under environment radiance SH, one vec4f (rgb, unused) per
// coefficient; not clamped.
fn irradiance_from_radiance_sh(coefficients: array<vec4f, 9>, normal: vec3f) -> vec3f {
    let x = normal.x;
    let y = normal.y;
    let z = normal.z;
    let band0 = SH_Y0 * coefficients[0].rgb;
    let band1 = SH_Y1
        * (y * coefficients[1].rgb + z * coefficients[2].rgb + x * coefficients[3].rgb);
    let band2 = SH_Y2_XY * (x * y * coefficients[4].rgb + y * z * coefficients[5].rgb)
        + SH_Y2_Z * (3.0 * z * z - 1.0) * coefficients[6].rgb
        + SH_Y2_XY * x * z * coefficients[7].rgb
        + SH_Y2_X * (x * x - y * y) * coefficients[8].rgb;
    return SH_PI * (band0 + 2.0 / 3.0 * band1 + 0.25 * band2);
}

// Radiance of environment SH towards a unit direction; not clamped.
fn sh_evaluate(coefficients: array<vec4f, 9>, direction: vec3f) -> vec3f {
    let x = direction.x;
    let y = direction.y;
    let z = direction.z;
    return SH_Y0 * coefficients[0].rgb
        + SH_Y1 * (y * coefficients[1].rgb + z * coefficients[2].rgb + x * coefficients[3].rgb)
        + SH_Y2_XY * (x * y * coefficients[4].rgb + y * z * coefficients[5].rgb)
        + SH_Y2_Z * (3.0 * z * z - 1.0) * coefficients[6].rgb
        + SH_Y2_XY * x * z * coefficients[7].rgb
        + SH_Y2_X * (x * x - y * y) * coefficients[8].rgb;
}
