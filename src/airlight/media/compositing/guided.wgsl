// Upsamples what was marched, and sharpens it by the density along each pixel's own ray (Elek2014 section 4.4).
//! use media_here
//! use packed_shares
//! use upsample_weight

// Texels whose transmittance differs by more are not interpolated.
const SAME_MEDIUM = 0.02;
// Below this opacity its colour is not known well enough to scale by.
const LEAST_HIDDEN = 1e-4;

struct Sharpened {
    @location(0) scattered: vec4f,
    @location(1) transmittance: vec4f,
}

struct OwnRay {
    passed: vec3f,      // the transmittance
    glow: vec3f,        // what media emit towards the eye, W m^-2 sr^-1
}

// A pixel's ray by the steps of the march; 1 and none where it is not needed.
fn own_ray(direction: vec3f, reach: f32, is_asked: bool) -> OwnRay {
    let hull = media_enter(rays.eye, direction, reach);
    let end = select(-1.0, hull.y, is_asked);
    let longest = max(march.step, (hull.y - hull.x) / f32(march.max_steps));
    if (HAS_EMISSION) {
        media_copied();
    }
    var depth = vec3f(0.0);
    var glow = vec3f(0.0);
    var t = hull.x;
    // Borders of media cut steps short, and grids want steps of their own.
    let most = 2u * march.max_steps + GRID_COUNT * u32(MAX_COLUMN_STEPS);
    for (var i = 0u; i < most && t < end; i++) {
        let dt = min(media_step_limit(t, longest), end - t);
        let p = rays.eye + (t + 0.5 * dt) * direction;
        // What glows is asked for medium by medium; for the transmittance alone their sum will do.
        if (HAS_EMISSION) {
            densities_at(p, t + 0.5 * dt);
            let step = depth_here(t, dt);
            glow += exp(-depth) * dt * mean_transmittance_rgb(step) * emitted_here;
            depth += step;
        } else {
            depth += homogeneous_depth(t, t + dt) + dt * grids_extinction(p, t + 0.5 * dt);
        }
        t += dt;
    }
    return OwnRay(exp(-depth), glow);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Sharpened {
    // Light and transmittance of the four texels around the pixel, by depth.
    let own = own_distance(position.xy);
    var light = vec3f(0.0);
    var through = vec3f(0.0);
    var total = 0.0;
    var is_glowing = false;
    var low = vec3f(1.0);
    var high = vec3f(0.0);
    for (var k = 0u; k < 4u; k++) {
        let one = upsampled(position.xy, own, k);
        let T = textureLoad(passed, one.texel, 0).rgb;
        let found = textureLoad(reduced, one.texel, 0);
        // What media emit has no opacity to follow: the pixel's own ray finds it.
        let emitted = select(vec3f(0.0), unpacked_shares(found.a), HAS_EMISSION);
        is_glowing = is_glowing || any(emitted > vec3f(0.0));
        light += one.weight * (1.0 - emitted) * found.rgb;
        through += one.weight * T;
        total += one.weight;
        low = min(low, T);
        high = max(high, T);
    }
    light /= total;
    through /= total;
    // Where the texels differ, the pixel's own transmittance is marched, and its light follows its opacity.
    let differs = any(high - low > vec3f(SAME_MEDIUM));
    let direction = pixel_direction(rays.world_from_clip, position.xy, vec2f(rays.size));
    let exact = own_ray(normalize(direction), own, differs || is_glowing);
    let hidden = 1.0 - through;
    let gain = select((1.0 - exact.passed) / max(hidden, vec3f(LEAST_HIDDEN)), vec3f(1.0),
        (hidden < vec3f(LEAST_HIDDEN)) | vec3<bool>(!differs));
    return Sharpened(vec4f(light * gain + exact.glow, 1.0), vec4f(select(through, exact.passed, differs), 1.0));
}
