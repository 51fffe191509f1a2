// Exposure and tone curves; sources and constants stand in maths/tone.py and maths/colour.py.
// Every curve: linear Rec.709 radiance, exposed, to display-linear [0, 1].

const TONE_NONE = 0u;
const TONE_AGX = 1u;
const TONE_ACES = 2u;
const TONE_NEUTRAL = 3u;

fn luminance(rgb: vec3f) -> f32 {
    return dot(rgb, vec3f(0.2126, 0.7152, 0.0722));
}

fn srgb_encode(linear: vec3f) -> vec3f {
    let x = clamp(linear, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(x, vec3f(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3f(0.0031308));
}

fn srgb_decode(encoded: vec3f) -> vec3f {
    let x = clamp(encoded, vec3f(0.0), vec3f(1.0));
    return select(pow((x + 0.055) / 1.055, vec3f(2.4)), x / 12.92, x <= vec3f(0.04045));
}

// WGSL may assume that no value is NaN, so the test is on bits.
fn finite_or_zero(c: vec3f) -> vec3f {
    let exponent = bitcast<vec3u>(c) & vec3u(0x7f800000u);
    return select(c, vec3f(0.0), exponent == vec3u(0x7f800000u));
}

const AGX_PIVOT = 10.0 / 16.5;
const AGX_INSET_WEIGHTS = vec3f(0.2120053547523427, 0.3921825078090138, 0.3958121374386435);

fn agx_curve(encoded: vec3f) -> vec3f {
    let offset = encoded - AGX_PIVOT;
    let low = offset < vec3f(0.0);
    let power = select(vec3f(3.25), vec3f(3.0), low);
    let bend = select(vec3f(69.86278913545539), vec3f(59.507875), low);
    return 0.5 + 2.0 * offset * pow(1.0 + bend * pow(abs(offset), power), -1.0 / power);
}

fn agx(radiance: vec3f) -> vec3f {
    let c = max(radiance, vec3f(0.0));
    let inset = 0.8 * c + 0.2 * dot(c, AGX_INSET_WEIGHTS);
    let stops = log2(max(inset, vec3f(1e-10)) / 0.18);
    let shown = agx_curve(clamp((stops + 10.0) / 16.5, vec3f(0.0), vec3f(1.0)));
    let outset = (shown - 0.2 * dot(shown, AGX_INSET_WEIGHTS)) / 0.8;
    return pow(clamp(outset, vec3f(0.0), vec3f(1.0)), vec3f(2.2));
}

fn aces(radiance: vec3f) -> vec3f {
    let c = max(radiance, vec3f(0.0)) / 0.6;
    // Into the primaries of the fit, through Hill's rational curve, and back.
    let ap1 = vec3f(
        dot(c, vec3f(0.59719, 0.35458, 0.04823)),
        dot(c, vec3f(0.07600, 0.90834, 0.01566)),
        dot(c, vec3f(0.02840, 0.13383, 0.83777)),
    );
    let v = min(ap1, vec3f(1e6));
    let fitted = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    return clamp(
        vec3f(
            dot(fitted, vec3f(1.60475, -0.53108, -0.07367)),
            dot(fitted, vec3f(-0.10208, 1.10813, -0.00605)),
            dot(fitted, vec3f(-0.00327, -0.07276, 1.07602)),
        ),
        vec3f(0.0),
        vec3f(1.0),
    );
}

fn neutral(radiance: vec3f) -> vec3f {
    let start = 0.76;
    var c = max(radiance, vec3f(0.0));
    // What a dielectric reflects of all light alike is taken off.
    let x = min(c.r, min(c.g, c.b));
    c -= select(0.04, x - 6.25 * x * x, x <= 0.08);
    let peak = max(c.r, max(c.g, c.b));
    if (peak <= start) {
        return c;
    }
    // Peaks are compressed, and lose colour as they are.
    let room = 1.0 - start;
    let shown = 1.0 - room * room / (peak + room - start);
    let keep = 1.0 / (0.15 * (peak - shown) + 1.0);
    return clamp(c * (shown / peak) * keep + shown * (1.0 - keep), vec3f(0.0), vec3f(1.0));
}

// `curve` is one of TONE_*; `exposure_stops` scales by powers of two.
fn tone_map(radiance: vec3f, exposure_stops: f32, curve: u32) -> vec3f {
    let exposed = finite_or_zero(radiance) * exp2(exposure_stops);
    switch curve {
        case TONE_AGX: { return agx(exposed); }
        case TONE_ACES: { return aces(exposed); }
        case TONE_NEUTRAL: { return neutral(exposed); }
        default: { return clamp(exposed, vec3f(0.0), vec3f(1.0)); }
    }
}
