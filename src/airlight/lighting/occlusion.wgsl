// Horizons around each texel of the image as `occlusion_surfaces` hands it on.
//! use occlusion
//! use near_field_texel

override SLICES: u32 = 2;
override STEPS: u32 = 4;
override HAS_LIGHT: bool = false;    // what occludes shows its light

const OCCLUSION_PI = 3.14159265;
// Within this share of the radius surfaces occlude wholly; from there on less and less.
const FULL_RANGE = 0.4;
// Horizons that fade with distance hide less than rays that do; so much farther makes up for it
// (measured in a corner of two planes, tests/lighting/test_occlusion.py).
const REACH = 1.35;
// More samples near the point than far from it, where detail matters less.
const SPREAD = 2.0;
const NEAREST_PX = 1.3;         // nearer samples show the surface itself
const LARGEST_RADIUS = 0.25;    // of the image's height: neighbours in memory stay near
const LEAST_FACING = 0.05;      // cosine between a normal and the direction to the eye
const OFFSET = 1e-4;           // of the distance to the eye, towards it: depths are not exact

// From the eye, m.
fn point(pixel: vec2u, inverse: f32) -> vec3f {
    let at = vec2f(pixel) + 0.5;
    return (params.corner + at.x * params.right + at.y * params.down) / max(inverse, 1e-9);
}

struct Slice {
    p: vec3f,           // the surface point, m from the eye
    n: vec3f,           // its unit normal
    v: vec3f,           // unit, towards the eye
    axis: vec3f,        // unit, the slice's normal
    tangent: vec3f,     // unit, to the right of v
    sideways: vec3f,    // in the surface's plane, 1 along the axis
    size: f32,          // of the normal projected on it
    gamma: f32,         // rad, from v to that
    facing: vec2f,      // cosine and sine of it
    lowest: vec2f,      // the horizons that the surface's own plane is, cosines
    radius: f32,        // m
}

struct Sample {
    point: vec3f,       // m from the eye
    normal: vec3f,      // of any length
    light: vec3f,       // W m^-2 sr^-1
}

// Beyond the image's border, the pixel at it.
fn at_pixel(pixel: vec2i) -> Sample {
    let inside = vec2u(clamp(pixel, vec2i(0), vec2i(params.size) - 1));
    let inverse = params.depth_scale * textureLoad(depth, inside, 0);
    var light = vec3f(0.0);
    if (HAS_LIGHT) {
        light = textureLoad(lit, inside, 0).rgb;
    }
    return Sample(point(inside, inverse), textureLoad(normal, inside, 0).xyz, light);
}

fn at_texel(texel: vec2i) -> Sample {
    let inside = vec2u(clamp(texel, vec2i(0), vec2i(params.reduced) - 1));
    let there = textureLoad(surfaces, inside, 0);
    let pixel = inside * params.scale + surface_pixel(there);
    return Sample(point(pixel, bitcast<f32>(there.x)), surface_normal(there), surface_light(there));
}

// How far to look from a point: cells grow with the distance to the eye where lattices are nested.
fn radius_at(p: vec3f) -> f32 {
    return clamp(params.growth * length(p), params.radius, params.largest);
}

// Cosines between horizons and the direction to the eye, to its right and to its left.
struct Horizons {
    all: vec2f,         // of all that stands around
    lit: vec2f,         // of what shows us the side that faces the point, and so its light
    arcs: vec2f,        // how open the latter are
}

// The horizons, x of all and y of what is lit, as a sample raises them.
fn raised(before: vec2f, lowest: f32, s: Slice, there: Sample) -> vec2f {
    let found = there.point - s.p;
    if (dot(found, s.n) <= 0.0) {
        return before;
    }
    // Whole texels lie beside the slice: moved onto it, along the surface, at the same height.
    let delta = found - s.sideways * dot(found, s.axis);
    let distance = max(length(delta), 1e-9);
    let weight = saturate((1.0 - distance / (REACH * s.radius)) / (1.0 - FULL_RANGE));
    let own = mix(lowest, dot(delta, s.v) / distance, weight);
    let is_seen = HAS_LIGHT && dot(there.normal, found) < 0.0;
    return max(before, vec2f(own, select(lowest, own, is_seen)));
}

// The unit direction to an occluder that raises the horizon from `low` to `high`, cosines; `tangent` on
// its side.
fn direction_between(s: Slice, tangent: vec3f, low: f32, high: f32) -> vec3f {
    let sines = sqrt(max(1.0 - low * low, 0.0)) + sqrt(max(1.0 - high * high, 0.0));
    let middle = (low + high) * s.v + sines * tangent;
    return middle / max(length(middle), 1e-4);
}

// Of occluders that show their light, each by the share of what may come in that it hides.
var<private> near: NearField;

// The horizons after a sample on each side. What shows us its back is not taken for black: its light is
// left to the lattice, or to what is seen beyond.
fn searched(s: Slice, before: Horizons, right: Sample, left: Sample) -> Horizons {
    let plus = raised(vec2f(before.all.x, before.lit.x), s.lowest.x, s, right);
    let minus = raised(vec2f(before.all.y, before.lit.y), s.lowest.y, s, left);
    let all = vec2f(plus.x, minus.x);
    if (!HAS_LIGHT) {
        return Horizons(all, before.lit, before.arcs);
    }
    let now = visible_arcs(vec2f(plus.y, minus.y), s.facing);
    let share = s.size * (before.arcs - now);
    near.light += share.x * right.light + share.y * left.light;
    near.direction += share.x * direction_between(s, s.tangent, before.lit.x, plus.y)
        + share.y * direction_between(s, -s.tangent, before.lit.y, minus.y);
    near.hidden += share.x + share.y;
    return Horizons(all, vec2f(plus.y, minus.y), now);
}

// The slice that looks along `across` (unit) in the image.
fn slice_along(across: vec2f, p: vec3f, v: vec3f, n: vec3f) -> Slice {
    let along = normalize(across.x * params.right + across.y * params.down);
    let tangent = along - dot(along, v) * v;
    let axis = normalize(cross(tangent, v));
    let projected = n - axis * dot(n, axis);
    let size = length(projected);
    let sideways = (axis - n * dot(n, axis)) / max(size * size, 1e-4);
    let cosine = clamp(dot(projected, v) / max(size, 1e-6), -1.0, 1.0);
    let gamma = sign(dot(tangent, projected)) * acos(cosine);
    let facing = vec2f(cosine, sign(gamma) * sqrt(1.0 - cosine * cosine));
    let lowest = vec2f(-facing.y, facing.y);
    return Slice(p, n, v, axis, normalize(tangent), sideways, size, gamma, facing, lowest,
        radius_at(p));
}

// Visibility of a slice, and without occluders. The nearest sample is a pixel, all others are texels.
fn slice_visibility(
    s: Slice, pixel: vec2i, texel: vec2i, across: vec2f, offset: f32, radius_px: f32,
) -> vec2f {
    var found = Horizons(s.lowest, s.lowest, visible_arcs(s.lowest, s.facing));
    // The nearest sample at full size, both ways along the slice: contacts are thin.
    let nearest = max(pow(offset / f32(STEPS), SPREAD) * radius_px, NEAREST_PX);
    let first = vec2i(round(across * nearest));
    found = searched(s, found, at_pixel(pixel + first), at_pixel(pixel - first));
    // Farther ones among the reduced texels, spread by a power of the distance.
    var i = 1u;
    loop {
        if (STEPS < 2u) { break; }
        let share = pow((f32(i) + offset) / f32(STEPS), SPREAD);
        let away = max(share * radius_px, NEAREST_PX + f32(i)) / f32(params.scale);
        let moved = vec2i(round(across * away));
        found = searched(s, found, at_texel(texel + moved), at_texel(texel - moved));
        i++;
        if (i >= STEPS) { break; }
    }
    // The arcs that are left above both horizons, weighted by the slice's share of the hemisphere.
    let open = visible_arcs(found.all, s.facing);
    return s.size * vec2f(open.x + open.y, s.facing.x + s.gamma * s.facing.y);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4u {
    let texel = vec2u(position.xy);
    let own = textureLoad(surfaces, texel, 0);
    let inverse = bitcast<f32>(own.x);
    if (inverse <= 0.0) {
        return packed_near_field(NearField(1.0, vec3f(0.0), vec3f(0.0), 0.0), 0.0);
    }
    let pixel = texel * params.scale + surface_pixel(own);
    let on_surface = point(pixel, inverse);
    let v = normalize(-on_surface);
    let p = on_surface * (1.0 - OFFSET);
    // Normals between corners may look away from the eye, where nothing is open.
    let shading_normal = normalize(surface_normal(own));
    let n = normalize(shading_normal + max(LEAST_FACING - dot(shading_normal, v), 0.0) * v);
    let wanted_px = REACH * radius_at(p) * inverse / length(params.right);
    let radius_px = min(wanted_px, LARGEST_RADIUS * f32(params.size.y));
    if (radius_px < NEAREST_PX) {
        return packed_near_field(NearField(1.0, vec3f(0.0), vec3f(0.0), 0.0), 1.0 / inverse);
    }
    // Jimenez2016: sixteen rotations and four offsets, each once in every 4 x 4 texels.
    let turn = f32((((texel.x + texel.y) & 3u) << 2u) + (texel.x & 3u)) / 16.0;
    let offset = 0.25 * f32((texel.y - texel.x) & 3u) + 0.125;
    var open = vec2f(0.0);
    // Loops end with their test, after which CPU adapters run nothing.
    var i = 0u;
    loop {
        let angle = (f32(i) + turn) / f32(SLICES) * OCCLUSION_PI;
        let across = vec2f(cos(angle), sin(angle));
        let s = slice_along(across, p, v, n);
        open += slice_visibility(s, vec2i(pixel), vec2i(texel), across, offset, radius_px);
        i++;
        if (i >= SLICES) { break; }
    }
    // differs: the paper divides by the number of slices; few of them then shade tilted planes.
    let scale = 1.0 / max(open.y, 1e-6);
    near = NearField(saturate(open.x * scale), near.light * scale, near.direction * scale,
        near.hidden * scale);
    return packed_near_field(near, 1.0 / inverse);
}
