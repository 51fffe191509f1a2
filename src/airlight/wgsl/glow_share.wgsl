// What of the light of things that glow a smooth surface shows by its mirrored rays; the rest is highlights of lights.

const GLOW_SHARP = 0.01;    // of alpha: smoother surfaces show lights as rays meet them
const GLOW_BLURRED = 0.16;  // rougher ones as highlights

// Media that glow are seen in pixels by few rays, so highlights, which are smooth, take over as soon as they are as wide
// as the lights lie apart.
const MEDIUM_BLURRED = 0.06;

fn medium_glow_share(alpha: f32) -> f32 {
    return 1.0 - smoothstep(GLOW_SHARP, MEDIUM_BLURRED, alpha);
}

fn glow_share(alpha: f32) -> f32 {
    return 1.0 - smoothstep(GLOW_SHARP, GLOW_BLURRED, alpha);
}

// As a ray's start has it in its fourth component, which is above 0 where there is a ray.
fn packed_glow_share(share: f32) -> f32 {
    return 0.5 + 0.5 * share;
}

fn unpacked_glow_share(packed: f32) -> f32 {
    return 2.0 * packed - 1.0;
}
