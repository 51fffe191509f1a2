// Single scattering by jittered steps, one sample of each light in each.
//! use eye_ray
//! use media_light
//! use media_ray
//! use lights_in_media

// Sixteen offsets in a step, in the order of a 4 x 4 Bayer matrix.
fn bayer(pixel: vec2u) -> f32 {
    let p = pixel & vec2u(3u);
    let q = (p.x ^ p.y);
    let order = ((q & 1u) << 3u) | ((p.y & 1u) << 2u) | (q & 2u) | ((p.y & 2u) >> 1u);
    return (f32(order) + 0.5) / 16.0;
}

fn is_lit_in(clip: vec4f) -> bool {
    return clip.w > 0.0 && all(abs(clip.xy) < clip.ww);
}

// 1 where the light reaches p unshadowed by surfaces; bilinear at the shadow's edge.
fn visibility(light: LightData, p: vec3f) -> f32 {
    if (light.kind == LIGHT_DIRECTIONAL) {
        let view = light.first_view;
        let clip = row_of_parallel_views(view).clip_from_world * vec4f(p, 1.0);
        let uv = clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5;
        let lit = textureSampleCompareLevel(
            parallel_shadows, shadow_compare, uv, view, min(clip.z / clip.w, 1.0));
        return select(1.0, lit, is_lit_in(clip));
    }
    let view = view_of(light, light.position - p);
    let clip = row_of_local_views(view).clip_from_world * vec4f(p, 1.0);
    let uv = clip.xy / clip.w * vec2f(0.5, -0.5) + 0.5;
    let lit = textureSampleCompareLevel(
        local_shadows, shadow_compare, uv, view, clamp(clip.z / clip.w, 0.0, 1.0));
    return select(1.0, lit, is_lit_in(clip));
}

// Where in t0..t1 to sample a light: x the ray parameter, y the weight of its irradiance, which
// for a local light is the exact integral of 1/r^2.
fn sampled_distance(light: LightData, direction: vec3f, t0: f32, t1: f32, u: f32) -> vec2f {
    if (light.kind == LIGHT_DIRECTIONAL) {
        return vec2f(mix(t0, t1, u), t1 - t0);
    }
    let to_light = light.position - rays.eye;
    let t_near = dot(to_light, direction);
    let h = max(softened(light, length(to_light - t_near * direction)), 1e-4 * (abs(t_near) + t1) + 1e-9);
    let x0 = atan((t0 - t_near) / h);
    let x1 = atan((t1 - t_near) / h);
    return vec2f(t_near + h * tan(mix(x0, x1, u)), (x1 - x0) / h);
}

// One light's share of a step, scattered to the eye, before the media attenuate it on the path there.
fn step_radiance(
    light: LightData, index: u32, direction: vec3f, sample: vec2f,
) -> vec3f {
    let p = rays.eye + sample.x * direction;
    // How much arrives at the sample, and by which angle it would be scattered to the eye.
    var gain = sample.y;
    var mu = -dot(light.direction, direction);
    var sharpness = 1.0;
    if (light.kind != LIGHT_DIRECTIONAL) {
        let away = p - light.position;
        let seen = seen_light(light, away, -direction, sqrt(dot(away, away) + light.nearest),
            -dot(normalize(away), direction));
        gain *= seen.gain;
        mu = seen.mu;
        sharpness = seen.sharpness;
    }
    // Shadow maps and media are asked only where anything arrives.
    if (gain <= 0.0) {
        return vec3f(0.0);
    }
    gain *= visibility(light, p);
    if (gain <= 0.0) {
        return vec3f(0.0);
    }
    return gain * light.color * media_phase_scattering(p, mu, sharpness, light.kind != LIGHT_DIRECTIONAL)
        * media_light_transmittance(light, index, p);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= rays.reduced)) {
        return;
    }
    // The ray, cut into equal steps; a phase of the jitter by pixel and frame.
    let ray = picked_ray(rays, id.xy, textureLoad(picked, vec2i(id.xy), 0).xy);
    let hull = media_enter(rays.eye, ray.direction, ray.distance);
    let longest = max((hull.y - hull.x) / f32(params.steps), 1e-6);
    let u = fract(bayer(id.xy) + f32(rays.frame) * 0.6180340);
    // What each light scatters in each step, attenuated on the path to the eye.
    var sum = vec3f(0.0);
    var grid_depth = vec3f(0.0);
    var t = hull.x;
    let most = params.steps * (2u + 2u * MEDIA_COUNT);
    for (var i = 0u; i < most && t < hull.y; i++) {
        let dt = min(jitter_step(t, longest), hull.y - t);
        let grids = grids_extinction(rays.eye + (t + u * dt) * ray.direction, t + u * dt);
        var k = 0u;
        loop {
            let light = row_of_lights(k);
            let sample = sampled_distance(light, ray.direction, t, t + dt, u);
            let depth = homogeneous_depth(0.0, sample.x) + grid_depth + grids * (sample.x - t);
            sum += exp(-depth) * step_radiance(light, k, ray.direction, sample);
            k++;
            if (k >= params.light_count) { break; }
        }
        grid_depth += grids * dt;
        t += dt;
    }
    textureStore(scattered, id.xy, vec4f(sum, 1.0));
}

// Borders of media end steps; a grid's stretch is cut into as many steps as the whole ray is, but
// none finer than its voxels.
fn jitter_step(t: f32, longest: f32) -> f32 {
    var limit = longest;
    for (var k = 0u; k < ray_media(); k++) {
        let m = ray_medium(k);
        let span = medium_intervals[k];
        if (span.x <= t && t < span.y) {
            limit = min(limit, span.y - t);
            if (GRID_COUNT > 0u && row_of_media(m).kind == MEDIUM_GRID) {
                limit = min(limit, max(row_of_media(m).voxel, (span.y - span.x) / f32(params.steps)));
            }
        } else if (span.x > t) {
            limit = min(limit, span.x - t);
        }
    }
    return max(limit, 2e-7 * t + 1e-7);
}
