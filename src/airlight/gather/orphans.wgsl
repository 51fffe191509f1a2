// Of each block the orphan pixels: those that no point around is like, nor an orphan of the block before them.
//! use pixel_point
//! use flat_normal
//! use gather
//! use sampling

const ORPHAN = 0.05;        // weight of the points around below which a pixel is one
const MOST = 3u;            // of a block
const TRIED = 12u;          // pixels of a block that are looked at in a sample

struct Orphan {
    place: vec3f,
    plane: vec3f,
}

// How far the four points around a pixel are like it, as pixels weight them (upsample.wgsl).
fn kept_by_points(position: vec2f, p: vec3f, n: vec3f, texel_m: f32) -> f32 {
    let last = vec2i(params.reduced) - 1;
    let middle = position / f32(params.scale) - 0.5;
    var total = 0.0;
    for (var k = 0; k < 4; k++) {
        let corner = vec2i(floor(middle)) + vec2i(k % 2, k / 2);
        let at = clamp(corner, vec2i(0), last);
        let place = textureLoad(places, at, 0);
        let near = max(1.0 - abs(middle - vec2f(corner)), vec2f(0.0));
        let like = near.x * near.y * likeness(p, n, place.xyz, textureLoad(planes, at, 0).xyz, texel_m);
        total += select(0.0, like, place.w > 0.0);
    }
    return total;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let size = vec2u(params.size);
    let count = params.scale * params.scale;
    let first = u32(f32(count) * r2_noise(id.x, id.y, params.sample));
    var own: array<Orphan, MOST>;
    var chosen = vec3u(0u);
    var found = 0u;
    for (var k = 0u; k < min(count, TRIED); k++) {
        // Steps that would visit each pixel once, far from the ones before it.
        let within = (first + k * params.step) % count;
        let pixel = id.xy * params.scale + vec2u(within % params.scale, within / params.scale);
        if (any(pixel >= size)) { continue; }
        let d = textureLoad(depth, pixel, 0);
        if (d <= 0.0) { continue; }
        let position = vec2f(pixel) + 0.5;
        let p = pixel_point(position, d);
        let n = flat_normal(vec2i(pixel), p, normalize(textureLoad(normal, pixel, 0).xyz));
        let texel_m = params.texel * length(p - params.eye);
        var total = kept_by_points(position, p, n, texel_m);
        for (var i = 0u; i < found; i++) {
            total += likeness(p, n, own[i].place, own[i].plane, texel_m);
        }
        if (total < ORPHAN) {
            own[found] = Orphan(p, n);
            chosen[found] = within;
            found++;
            if (found >= MOST) { break; }
        }
    }
    choices[id.y * params.reduced.x + id.x] = vec4u(chosen, found);
}
