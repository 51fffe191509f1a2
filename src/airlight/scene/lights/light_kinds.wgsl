// Types of lights by `LightData.kind`, and how those send that send more in some directions than in others. Twins:
// `LightType.kind` and `LightType.sent_share` of each type's module.

const LIGHT_DIRECTIONAL = 0u;
const LIGHT_POINT = 1u;
const LIGHT_SPOT = 2u;      // from here on by direction
const LIGHT_SAMPLE = 3u;

fn sends_by_direction(kind: u32) -> bool {
    return kind >= LIGHT_SPOT;
}

// A spot fades between its half angles by the smoothstep of the cosine; `shape`: cosines of the inner and outer one.
fn spot_share(cosine: f32, shape: vec2f) -> f32 {
    return smoothstep(shape.y, max(shape.x, shape.y + 1e-4), cosine);
}

// A sample of a surface sends by the cosine, and to all sides; `shape`: how much of each.
fn sample_share(cosine: f32, shape: vec2f) -> f32 {
    return shape.x * max(cosine, 0.0) + shape.y;
}

// The share of its strength that a light which sends by direction sends at a cosine from its own.
fn share_at(kind: u32, cosine: f32, shape: vec2f) -> f32 {
    if (kind == LIGHT_SAMPLE) {
        return sample_share(cosine, shape);
    }
    return spot_share(cosine, shape);
}

// The twin of maths.area_light.softened_gain.
fn softened_gain(nearest: f32, squared: f32) -> f32 {
    let share = nearest / squared;
    return 1.0 + share + 4.0 * share * share;
}
