// Lists the pixels that send mirrored rays: those that mirror enough, but of rough ones that are alike one of a block.
//! use pixel_point
//! use surface_reflection
//! use packed_pixel
//! use gather
//! use mirrored_by

const ALIKE_SURFACE = 0.9;  // likeness of the surfaces of two pixels that do
const ALIKE_ALPHA = 1.2;    // most ratio of their alphas

struct Mirroring {
    p: vec3f,
    n: vec3f,
    alpha: f32,
    away_m: f32,    // from the eye
    is_any: bool,   // mirrors enough
}

fn mirroring(pixel: vec2u) -> Mirroring {
    let d = textureLoad(depth, pixel, 0);
    let p = pixel_point(vec2f(pixel) + 0.5, d);
    let base = textureLoad(albedo, pixel, 0);
    let facing = textureLoad(normal, pixel, 0);
    let n = normalize(facing.xyz);
    // How much the surface mirrors to the eye.
    let away_m = distance(params.eye, p);
    let r = reflector(base.rgb, base.a, facing.w, textureLoad(emission, pixel, 0).a);
    let n_v = max(dot(n, (params.eye - p) / away_m), 1e-4);
    let share = glossy_share(specular_albedo(r, n_v), sqrt(r.alpha));
    return Mirroring(p, n, r.alpha, away_m, d > 0.0 && share > 0.0);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= vec2u(params.size))) {
        return;
    }
    let own = mirroring(id.xy);
    var by = select(BY_NONE, BY_OWN, own.is_any);
    // A wide lobe shows what a neighbour's does: of a block one pixel sends a ray, and the others take that.
    let chosen = pixel_of_block(id.xy);
    if (own.is_any && own.alpha >= WIDE && any(chosen != id.xy)) {
        let other = mirroring(chosen);
        let is_alike = likeness(own.p, own.n, other.p, other.n, params.texel * own.away_m) >= ALIKE_SURFACE;
        let ratio = max(own.alpha, other.alpha) / min(own.alpha, other.alpha);
        if (other.is_any && is_alike && ratio <= ALIKE_ALPHA) {
            by = BY_BLOCK;
        }
    }
    if (by == BY_OWN) {
        listed[atomicAdd(&found[0], 1u)] = packed_pixel(id.xy);
    }
    textureStore(senders, id.xy, vec4u(by, 0u, 0u, 0u));
}
