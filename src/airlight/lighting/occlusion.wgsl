//! use occlusion

override SLICES: u32 = 2;
override STEPS: u32 = 4;
override HAS_LIGHT: bool = false;    // what occludes shows its light in `lit`

const OCCLUSION_PI = 3.14159265;
// Within this share of the radius surfaces occlude wholly; from there on less and less.
const FULL_RANGE = 0.4;
// Horizons that fade with distance hide less than rays that do; so much farther makes up for it
// (measured in a corner of two planes, tests/lighting/test_occlusion.py).
const REACH = 1.35;
// More samples near the point than far from it, where detail matters less.
const SPREAD = 2.0;
const NEAREST_PX = 1.3;         // nearer samples show the surface itself
const LARGEST_RADIUS = 0.25;    // of the picture's height: neighbours in memory stay near
const SAME_SURFACE = 0.1;       // depths that differ by less than this share
const LEAST_FACING = 0.05;      // cosine between a normal and the direction to the eye
const OFFSET = 1e-4;           // of the distance to the eye, towards it: depths are not exact

fn inverse_distance(pixel: vec2i) -> f32 {
    return params.depth_scale * textureLoad(depth, pixel, 0);
}

// From the eye, m.
fn point(pixel: vec2i, inverse: f32) -> vec3f {
    let at = vec2f(pixel) + 0.5;
    return (params.corner + at.x * params.right + at.y * params.down) / max(inverse, 1e-9);
}

// The pixel that stands for a texel: where its block has an edge, the near and the far side in
// turn (as on a chessboard), so that both are there for reading it at full size.
fn chosen_pixel(texel: vec2u) -> vec2i {
    let first = texel * params.scale;
    let last = params.size - 1u;
    var nearest = vec3f(-1.0);
    var farthest = vec3f(1e30);
    for (var k = 0u; k < params.scale * params.scale; k++) {
        let pixel = min(first + vec2u(k % params.scale, k / params.scale), last);
        let inverse = inverse_distance(vec2i(pixel));
        if (inverse > nearest.x) { nearest = vec3f(inverse, vec2f(pixel)); }
        if (inverse < farthest.x) { farthest = vec3f(inverse, vec2f(pixel)); }
    }
    if (nearest.x - farthest.x <= SAME_SURFACE * nearest.x) {
        return vec2i(min(first + params.scale / 2u, last));
    }
    return vec2i(select(nearest.yz, farthest.yz, ((texel.x + texel.y) & 1u) == 1u));
}

struct Slice {
    p: vec3f,           // the surface point, m from the eye
    n: vec3f,           // its unit normal
    v: vec3f,           // unit, towards the eye
    axis: vec3f,        // unit, the slice's normal
    sideways: vec3f,    // in the surface's plane, 1 along the axis
    radius: f32,        // m
}

// How far to look from a point: cells grow with the distance to the eye where lattices are nested.
fn radius_at(p: vec3f) -> f32 {
    return clamp(params.growth * length(p), params.radius, params.largest);
}

// Cosines between horizons and the direction to the eye.
struct Horizon {
    all: f32,           // of all that stands around
    lit: f32,           // of what shows us the side that faces the point, and so its light
}

// The horizons as one sample raises them.
fn raised(before: Horizon, lowest: f32, s: Slice, pixel: vec2i) -> Horizon {
    let inside = clamp(pixel, vec2i(0), vec2i(params.size) - 1);
    let found = point(inside, inverse_distance(inside)) - s.p;
    if (dot(found, s.n) <= 0.0) {
        return before;
    }
    // Whole pixels lie beside the slice: moved onto it, along the surface, at the same height.
    let delta = found - s.sideways * dot(found, s.axis);
    let distance = max(length(delta), 1e-9);
    let weight = saturate((1.0 - distance / (REACH * s.radius)) / (1.0 - FULL_RANGE));
    let own = mix(lowest, dot(delta, s.v) / distance, weight);
    let all = max(before.all, own);
    if (!HAS_LIGHT) {
        return Horizon(all, lowest);
    }
    let is_seen = dot(textureLoad(normal, inside, 0).xyz, found) < 0.0;
    return Horizon(all, select(before.lit, max(before.lit, own), is_seen));
}

// Of occluders whose light is known, each by the share of what may come in that they hide: their
// radiance, W m^-2 sr^-1, the unit directions to them, and that share.
struct Near {
    light: vec3f,
    way: vec3f,
    hidden: f32,
}

// What a sample adds that raises the horizon of what is lit, cosines too; `tangent` on its side. What shows
// us its back is not taken for black: its light is left to the lattice, or to what is seen beyond.
fn hidden_by(s: Slice, tangent: vec3f, before: f32, after: f32, share: f32, pixel: vec2i) -> Near {
    let low = before * s.v + sqrt(max(1.0 - before * before, 0.0)) * tangent;
    let high = after * s.v + sqrt(max(1.0 - after * after, 0.0)) * tangent;
    let middle = low + high;
    let way = middle / max(length(middle), 1e-4);
    let inside = clamp(pixel, vec2i(0), vec2i(params.size) - 1);
    return Near(share * textureLoad(lit, inside, 0).rgb, share * way, share);
}

fn sum_of(a: Near, b: Near) -> Near {
    return Near(a.light + b.light, a.way + b.way, a.hidden + b.hidden);
}

var<private> near: Near;

// Openness of the slice that looks along `across` (unit, px) in the picture, and without occluders.
fn slice_openness(
    pixel: vec2i, across: vec2f, offset: f32, radius_px: f32, p: vec3f, v: vec3f, n: vec3f,
) -> vec2f {
    let along = normalize(across.x * params.right + across.y * params.down);
    let tangent = along - dot(along, v) * v;
    let axis = normalize(cross(tangent, v));
    let projected = n - axis * dot(n, axis);
    let size = length(projected);
    let sideways = (axis - n * dot(n, axis)) / max(size * size, 1e-4);
    let s = Slice(p, n, v, axis, sideways, radius_at(p));
    let cosine = clamp(dot(projected, v) / max(size, 1e-6), -1.0, 1.0);
    let gamma = sign(dot(tangent, projected)) * acos(cosine);
    // The surface's own plane is the lowest horizon on each side.
    let lowest = vec2f(cos(gamma + 0.5 * OCCLUSION_PI), cos(gamma - 0.5 * OCCLUSION_PI));
    var ahead = Horizon(lowest.x, lowest.x);
    var behind = Horizon(lowest.y, lowest.y);
    let tangent_v = normalize(tangent);
    var arc = vec2f(visible_arc(acos(lowest.x), gamma), visible_arc(-acos(lowest.y), gamma));
    for (var i = 0u; i < STEPS; i++) {
        let share = pow((f32(i) + offset) / f32(STEPS), SPREAD);
        let moved = vec2i(round(across * max(share * radius_px, NEAREST_PX + f32(i))));
        let before = vec2f(ahead.lit, behind.lit);
        ahead = raised(ahead, lowest.x, s, pixel + moved);
        behind = raised(behind, lowest.y, s, pixel - moved);
        if (HAS_LIGHT) {
            let high = acos(clamp(vec2f(ahead.lit, behind.lit), vec2f(-1.0), vec2f(1.0)));
            let now = vec2f(visible_arc(high.x, gamma), visible_arc(-high.y, gamma));
            let hidden = size * (arc - now);
            near = sum_of(near, hidden_by(s, tangent_v, before.x, ahead.lit, hidden.x, pixel + moved));
            near = sum_of(near, hidden_by(s, -tangent_v, before.y, behind.lit, hidden.y, pixel - moved));
            arc = now;
        }
    }
    let high = acos(clamp(vec2f(ahead.all, behind.all), vec2f(-1.0), vec2f(1.0)));
    let open = visible_arc(high.x, gamma) + visible_arc(-high.y, gamma);
    return size * vec2f(open, cos(gamma) + gamma * sin(gamma));
}

struct Around {
    @location(0) light: vec4f,      // and the packed depth, m along the view axis, and occlusion
    @location(1) way: vec4f,        // and the share that is hidden by what shows its light
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Around {
    let texel = vec2u(position.xy);
    let pixel = chosen_pixel(texel);
    let inverse = inverse_distance(pixel);
    if (inverse <= 0.0) {
        return Around(vec4f(0.0), vec4f(0.0));
    }
    let on_surface = point(pixel, inverse);
    let v = normalize(-on_surface);
    let p = on_surface * (1.0 - OFFSET);
    // Normals between corners may look away from the eye, where nothing is open.
    let bent = normalize(textureLoad(normal, pixel, 0).xyz);
    let n = normalize(bent + max(LEAST_FACING - dot(bent, v), 0.0) * v);
    let wanted_px = REACH * radius_at(p) * inverse / length(params.right);
    let radius_px = min(wanted_px, LARGEST_RADIUS * f32(params.size.y));
    if (radius_px < NEAREST_PX) {
        return Around(vec4f(vec3f(0.0), packed_depth(1.0 / inverse, 0.0)), vec4f(0.0));
    }
    // Jimenez2016: sixteen rotations and four offsets, each once in every 4 x 4 texels.
    let turn = f32((((texel.x + texel.y) & 3u) << 2u) + (texel.x & 3u)) / 16.0;
    let offset = 0.25 * f32((texel.y - texel.x) & 3u) + 0.125;
    var open = vec2f(0.0);
    for (var i = 0u; i < SLICES; i++) {
        let angle = (f32(i) + turn) / f32(SLICES) * OCCLUSION_PI;
        open += slice_openness(pixel, vec2f(cos(angle), sin(angle)), offset, radius_px, p, v, n);
    }
    // differs: the paper divides by the number of slices; few of them then shade tilted planes.
    let scale = 1.0 / max(open.y, 1e-6);
    let occluded = 1.0 - saturate(open.x * scale);
    return Around(vec4f(near.light * scale, packed_depth(1.0 / inverse, occluded)),
        vec4f(near.way, near.hidden) * scale);
}
