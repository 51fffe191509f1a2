// A 2D digital differential analyser over a shadow map with bounds on its squares: descends where a
// ray passes between a square's nearest and farthest depth, ascends where it leaves a parent.
// The including pass declares fn shadow_word(entry: u32) -> u32, of the bounds of the map's squares.
// Source: Chen2011 (1D min-max mipmaps), in two dimensions.
//! use shadow_levels
//! needs fn shadow_word(entry: u32) -> u32

// Squares finer than this are not opened any more once a ray has spent its nodes.
const LAST_LEVEL = 3u;
const NOWHERE = 4.0;    // an s that is never reached

// One eye ray over one shadow map. It is a line there; s goes from 0 to 1 along it, and
// t is the ray parameter in the world.
struct Walk {
    is_parallel: bool,
    top: u32,           // the level that the ray starts at
    side: u32,          // texels, of level 0
    area: u32,          // the square of that
    rows: u32,          // its logarithm
    first: u32,         // entry of the map's bounds
    max_nodes: u32,     // parameters are copied: a CPU adapter reads a buffer lane by lane
    q0: vec2f,          // texels, at s = 0; of a mirrored map, so that the ray goes up its axes
    dq: vec2f,          // not negative
    inverse: vec2f,     // 1/dq
    mirror: vec2u,      // flips the bits of a texel of the mirrored map
    z: vec3f,           // shadow depth at s = 0, its slope, and 1 over that
    w: vec2f,           // clip w at s = 0 and 1
    t: vec2f,           // m, at s = 0 and 1
    begin: f32,         // m, where what lies before the map's reach begins
    end: f32,           // m, where what lies behind the map's reach ends
    nudge: f32,         // of s, a thousandth of a texel
    s: f32,             // 1 at the end
    level: u32,
    node: u32,
    lit_from: f32,      // s where the interval that is not yet ended began; NOWHERE in the dark
    interval: vec2f,    // s, the lit interval that was found last
    is_found: bool,     // whether there is one that was not yet taken
}

var<private> walk: Walk;

// Ray parameter at s, in perspective.
fn t_at(s: f32) -> f32 {
    return mix(walk.t.x, walk.t.y, s * walk.w.x / (s * walk.w.x + (1.0 - s) * walk.w.y));
}

// Lays the interval t0..t1 of the eye ray over a map of `resolution` texels. `outer` is the share of it
// that this map stands for, `inner` where the map has texels; between them nothing shadows.
fn enter_map(
    clip0: vec4f, step: vec4f, outer: vec2f, inner: vec2f, t0: f32, t1: f32, resolution: f32,
) {
    // Both ends in texels of the map.
    let c0 = clip0 + inner.x * step;
    let c1 = clip0 + inner.y * step;
    let half = vec2f(0.5, -0.5);
    // A hundredth of a texel inside, so that no step leaves the map.
    let most = vec2f(resolution - 0.01);
    let a = clamp((c0.xy / c0.w * half + 0.5) * resolution, vec2f(0.01), most);
    let b = clamp((c1.xy / c1.w * half + 0.5) * resolution, vec2f(0.01), most);
    // Mirrored so that the ray goes up both axes: one case instead of four.
    let is_back = b < a;
    walk.mirror = select(vec2u(0u), vec2u(walk.side - 1u), is_back);
    walk.q0 = select(a, f32(walk.side) - a, is_back);
    walk.dq = abs(b - a);
    walk.inverse = 1.0 / max(walk.dq, vec2f(1e-30));
    // Depth is linear along it, the ray parameter with it by both ends' w.
    let z = c0.z / c0.w;
    let dz = c1.z / c1.w - z;
    walk.z = vec3f(z, dz, 1.0 / select(dz, 1e-30, dz == 0.0));
    walk.w = vec2f(c0.w, c1.w);
    walk.t = t0 + inner * (t1 - t0);
    walk.begin = t0 + outer.x * (t1 - t0);
    walk.end = t0 + outer.y * (t1 - t0);
    // From the coarsest level on; what lies before the map's reach is lit.
    walk.nudge = 1e-3 / max(max(walk.dq.x, walk.dq.y), 1e-3);
    walk.s = 0.0;
    walk.level = walk.top;
    walk.node = 0u;
    walk.lit_from = select(NOWHERE, 0.0, outer.x < inner.x);
}

// The lit interval between two s, m; one from the map's very beginning began before it.
fn interval_between(a: f32, b: f32) -> vec2f {
    return vec2f(select(t_at(a), walk.begin, a <= 0.0), t_at(b));
}

// What is lit at the end of the map, and beyond it.
fn last_interval() -> vec2f {
    let is_lit = walk.lit_from < NOWHERE;
    let start = select(walk.t.y, interval_between(walk.lit_from, 1.0).x, is_lit);
    return vec2f(start, max(walk.t.y, walk.end));
}

// Crosses or opens one square, and stores the lit interval that ends in it, if any. Nothing branches: a CPU
// adapter would run all branches, and what each of them stores.
fn visit_square() {
    let at = walk.s + walk.nudge;
    let texel = vec2u(walk.q0 + at * walk.dq);
    let below = (1u << walk.level) - 1u;
    let exits = (vec2f((texel | vec2u(below)) + 1u) - walk.q0) * walk.inverse;
    let exit = min(max(min(exits.x, exits.y), at), 1.0);
    let z0 = min(walk.z.x + walk.s * walk.z.y, FARTHEST);
    let z1 = min(walk.z.x + exit * walk.z.y, FARTHEST);
    // As level_entry, without what is the same for all squares.
    let own = texel ^ walk.mirror;
    let row = (((own.y & ~below) << walk.rows) | walk.area) >> (2u * walk.level);
    let entry = walk.first + row + (own.x >> walk.level);
    let bounds = level_bounds(shadow_word(entry), walk.level);
    let is_lit = max(z0, z1) <= bounds.x;
    let is_dark = min(z0, z1) > bounds.y;
    // When the ray has spent its nodes, larger squares are taken as they are.
    let finest = select(0u, LAST_LEVEL, walk.node >= walk.max_nodes);
    let is_cut = !is_lit && !is_dark;
    let opens = is_cut && walk.level > finest;
    let splits = is_cut && !opens;
    // Where the ray passes the depth of one texel, or the middle one of a larger square.
    let middle = 0.5 * (bounds.x + bounds.y);
    let crossing = min(max((middle - walk.z.x) * walk.z.z, walk.s), exit);
    let falls = walk.z.y > 0.0;
    let goes_dark = splits && falls;
    // Lit before the crossing where the ray goes away from the light, else from there on.
    let start = select(walk.lit_from, min(walk.lit_from, walk.s), is_lit || goes_dark);
    let end = select(walk.s, crossing, goes_dark);
    let goes_on = is_lit || opens;
    store_interval(vec2f(start, end), !goes_on && end > start);
    walk.lit_from = select(select(NOWHERE, crossing, splits && !falls), start, goes_on);
    // On into the next square, up a level where that belongs to another parent.
    // Rows of squares are even in number: an entry is odd where its column is.
    let odd_x = (entry ^ walk.mirror.x) & 1u;
    let odd_y = (texel.y >> walk.level) & 1u;
    let ascends = select(odd_y, odd_x, exits.x < exits.y) != 0u && walk.level < walk.top;
    walk.level = select(walk.level + select(0u, 1u, ascends), walk.level - 1u, opens);
    walk.s = select(exit, walk.s, opens);
    walk.node++;
}

// Stores an interval of s as found.
fn store_interval(found: vec2f, is_found: bool) {
    walk.interval = select(walk.interval, found, is_found);
    walk.is_found = walk.is_found || is_found;
}

// Walks until a lit interval is found or the map ends; whether one was.
fn find_interval() -> bool {
    walk.is_found = false;
    if (walk.s < 1.0) {
        loop {
            visit_square();
            if (walk.node >= 4u * walk.max_nodes) { walk.s = 1.0; }
            if (walk.is_found || walk.s >= 1.0) { break; }
        }
    }
    return walk.is_found;
}

// The interval that was found, m.
fn found_interval() -> vec2f {
    return interval_between(walk.interval.x, walk.interval.y);
}
