// What a pixel mirrors: what its ray found and those of pixels around, each as far as the pixel's own lobe reaches there.
// Source: Stachowiak2015 (rays of neighbours, weighted by the BRDF of the pixel that takes them).
//! use pixel_point
//! use ray_start
//! use gather
//! use ggx_sampling
//! use specular_cosine
//! use mirrored_by

const AROUND = 16u;         // pixels that are asked
const TURN = 2.3999632;     // rad, the golden angle
const SHARP = 0.003;        // of alpha: smoother surfaces show their own rays alone
const NO_PIXEL = vec2u(0xffffffffu);

struct Asking {
    origin: vec3f,
    n: vec3f,
    v: vec3f,
    alpha: f32,
    texel_m: f32,
}

// The pixel whose ray one shows; none's, where it does not mirror, is far outside.
fn sender_of(pixel: vec2u) -> vec2u {
    switch textureLoad(senders, pixel, 0).x {
        case BY_OWN: { return pixel; }
        case BY_BLOCK: { return pixel_of_block(pixel); }
        default: { return NO_PIXEL; }
    }
}

// Weight of the `ray` of `pixel`.
fn ray_weight(own: Asking, pixel: vec2u, ray: vec4f) -> f32 {
    if (ray.w == NOWHERE) {
        return 0.0;
    }
    let p = pixel_point(vec2f(pixel) + 0.5, textureLoad(depth, pixel, 0));
    let facing = textureLoad(normal, pixel, 0);
    let n = normalize(facing.xyz);
    let alpha = max(facing.w * facing.w, 0.002);
    let away = params.eye - p;
    let v = normalize(away);
    let origin = ray_start(p, n, params.eye, params.texel);
    // How likely it went there, and how much its light is for this pixel.
    let sent = select(ray.xyz, normalize(ray.xyz - origin), ray.w == MET);
    let density = mirrored_density(saturate(dot(n, normalize(sent + v))), max(dot(n, v), 1e-4), alpha);
    let l = select(ray.xyz, normalize(ray.xyz - own.origin), ray.w == MET);
    let gloss = mirrored_gloss(saturate(dot(own.n, normalize(l + own.v))), saturate(dot(own.n, l)),
        max(dot(own.n, own.v), 1e-4), own.alpha);
    return gloss / max(density, 1e-20) * likeness(own.origin, own.n, origin, n, own.texel_m);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= vec2u(params.size))) {
        return;
    }
    var sky = vec4f(0.0);
    var light = vec4f(0.0);
    if (textureLoad(senders, id.xy, 0).x != BY_NONE) {
        // The pixel's surface, and which rays it would have sent.
        let p = pixel_point(vec2f(id.xy) + 0.5, textureLoad(depth, id.xy, 0));
        let facing = textureLoad(normal, id.xy, 0);
        let base = textureLoad(albedo, id.xy, 0);
        let r = reflector(base.rgb, base.a, facing.w, textureLoad(emission, id.xy, 0).a);
        let away = params.eye - p;
        let n = normalize(facing.xyz);
        let own = Asking(ray_start(p, n, params.eye, params.texel), n, normalize(away), r.alpha,
            4.0 * params.texel * length(away));
        // Rays of the pixels around it, by how likely its own would have been those; a sharp mirror takes its own alone.
        var whole = 0.0;
        let count = select(AROUND, 1u, r.alpha < SHARP);
        let reach = max(params.reach, select(0.0, NEXT_BLOCK, r.alpha >= WIDE));
        var k = 0u;
        loop {
            // A spiral, turned from sample to sample and as wide as so many of them ask.
            let turn = TURN * f32(k + AROUND * params.sample);
            let step = reach * sqrt(f32(k) / f32(AROUND)) * vec2f(cos(turn), sin(turn));
            let pixel = vec2i(id.xy) + vec2i(round(step));
            var other = NO_PIXEL;
            if (all(pixel >= vec2i(0)) && all(pixel < vec2i(params.size))) {
                other = sender_of(vec2u(pixel));
            }
            if (any(other != NO_PIXEL)) {
                let ray = textureLoad(mirrored_ends, other, 0);
                let weight = ray_weight(own, other, ray);
                let found = weight * textureLoad(mirrored_found, other, 0).rgb;
                let is_sky = ray.w == LEFT;
                sky += vec4f(select(vec3f(0.0), found, is_sky), weight);
                light += vec4f(select(found, vec3f(0.0), is_sky), weight);
            }
            k++;
            if (k >= count) { break; }
        }
        whole = sky.a;
        // Of their mean, as much as the surface mirrors.
        let albedos = specular_cosine(max(dot(n, own.v), 1e-4), r.alpha).albedos;
        let f90 = saturate(max(r.f0.x, max(r.f0.y, r.f0.z)) * 50.0);
        let gain = (r.f0 * albedos.x + vec3f(f90 * albedos.y)) / max(whole, 1e-20);
        sky = vec4f(gain * sky.rgb, f32(whole > 0.0));
        light = vec4f(gain * light.rgb, f32(whole > 0.0));
    }
    textureStore(mirrored_sky, id.xy, sky);
    textureStore(mirrored_light, id.xy, light);
}
