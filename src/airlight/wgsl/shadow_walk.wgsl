// A 2D digital differential analyser over a shadow map with bounds on its squares: descends where a
// ray passes between a square's nearest and farthest depth, ascends where it leaves a parent.
// The including pass declares fn shadow_bounds(level: u32, square: vec2u) -> vec2f, of the map that
// the walk is over.
// Source: Chen et al. 2011 (1D min-max mipmaps), in two dimensions.

// Squares finer than this are not opened any more once a ray has spent its nodes.
const LAST_LEVEL = 3u;
const FINISHED = 2.0;
const NOWHERE = 4.0;    // an s that is never reached

// One eye ray on its way over one shadow map. It is a line there; s goes from 0 to 1 along it, and
// t is the ray parameter in the world.
struct Walk {
    is_parallel: bool,
    view: u32,
    most: f32,          // texels, the farthest place inside
    top: u32,           // the level that the ray starts at
    side: u32,          // texels, of level 0
    max_nodes: u32,     // parameters are copied: a software driver reads a buffer lane by lane
    q0: vec2f,          // texels, at s = 0
    dq: vec2f,
    inverse: vec2f,     // 1/dq
    ahead: vec2f,       // 1 where dq is not negative
    z: vec3f,           // shadow depth at s = 0, its slope, and 1 over that
    w: vec2f,           // clip w at s = 0 and 1
    t: vec2f,           // m, at s = 0 and 1
    begin: f32,         // m, where what lies before the map's reach begins
    end: f32,           // m, where what lies behind the map's reach ends
    nudge: f32,         // of s, a thousandth of a texel
    s: f32,             // FINISHED at the end
    level: u32,
    node: u32,
    lit_from: f32,      // s where the run that is under way began; NOWHERE in the dark
}

var<private> walk: Walk;

// Ray parameter at s, in perspective.
fn t_at(s: f32) -> f32 {
    return mix(walk.t.x, walk.t.y, s * walk.w.x / (s * walk.w.x + (1.0 - s) * walk.w.y));
}

// Lay the stretch t0..t1 of the eye ray over a map of `resolution` texels. `outer` is the share of it
// that is this map's affair, `inner` where the map has texels; between them nothing shadows.
fn enter_map(
    clip0: vec4f, step: vec4f, outer: vec2f, inner: vec2f, t0: f32, t1: f32, resolution: f32,
) {
    let c0 = clip0 + inner.x * step;
    let c1 = clip0 + inner.y * step;
    let half = vec2f(0.5, -0.5);
    walk.most = resolution - 0.25;
    walk.q0 = (c0.xy / c0.w * half + 0.5) * resolution;
    walk.dq = (c1.xy / c1.w * half + 0.5) * resolution - walk.q0;
    walk.inverse = 1.0 / select(walk.dq, vec2f(1e-30), walk.dq == vec2f(0.0));
    walk.ahead = select(vec2f(0.0), vec2f(1.0), walk.dq >= vec2f(0.0));
    let z = c0.z / c0.w;
    let dz = c1.z / c1.w - z;
    walk.z = vec3f(z, dz, 1.0 / select(dz, 1e-30, dz == 0.0));
    walk.w = vec2f(c0.w, c1.w);
    walk.t = t0 + inner * (t1 - t0);
    walk.begin = t0 + outer.x * (t1 - t0);
    walk.end = t0 + outer.y * (t1 - t0);
    walk.nudge = 1e-3 / max(max(abs(walk.dq.x), abs(walk.dq.y)), 1e-3);
    walk.s = 0.0;
    walk.level = walk.top;
    walk.node = 0u;
    walk.lit_from = select(NOWHERE, 0.0, outer.x < inner.x);
}

// The run of light between two s; one from the map's very beginning began before it.
fn run_between(a: f32, b: f32) -> vec2f {
    return vec2f(select(t_at(a), walk.begin, a <= 0.0), t_at(b));
}

// What is lit at the end of the map, and beyond it.
fn last_run() -> vec2f {
    let is_lit = walk.lit_from < NOWHERE;
    let start = select(walk.t.y, run_between(walk.lit_from, 1.0).x, is_lit);
    return vec2f(start, max(walk.t.y, walk.end));
}

// Where the ray passes the depth of one texel; in a larger square, so that its lit share fits.
fn crossing_of(bounds: vec2f, exit: f32) -> f32 {
    let exact = clamp((bounds.x - walk.z.x) * walk.z.z, walk.s, exit);
    let high = min(bounds.y, 1.0);
    let middle = walk.z.x + 0.5 * (walk.s + exit) * walk.z.y;
    let share = saturate((high - middle) / max(high - bounds.x, 1e-9));
    let fitting = mix(walk.s, exit, select(1.0 - share, share, walk.z.y > 0.0));
    return select(fitting, exact, walk.level == 0u);
}

// Cross or open one square; returns the lit run (s) that ends in it, if any. Nothing branches: a
// software driver would run all branches, and what each of them stores.
fn visit_square() -> vec2f {
    let size = bitcast<f32>((127u + walk.level) << 23u);
    let inverse_size = bitcast<f32>((127u - walk.level) << 23u);
    let at = walk.s + walk.nudge;
    let place = clamp(walk.q0 + at * walk.dq, vec2f(0.0), vec2f(walk.most));
    let square = floor(place * inverse_size);
    let exits = ((square + walk.ahead) * size - walk.q0) * walk.inverse;
    let exit = min(max(min(exits.x, exits.y), at), 1.0);
    let z0 = walk.z.x + walk.s * walk.z.y;
    let z1 = walk.z.x + exit * walk.z.y;
    let bounds = shadow_bounds(walk.level, vec2u(square));
    let is_lit = max(z0, z1) <= bounds.x;
    let is_dark = min(z0, z1) > bounds.y;
    // When the ray has spent its nodes, larger squares are taken as they are.
    let finest = select(0u, LAST_LEVEL, walk.node >= walk.max_nodes);
    let opens = !is_lit && !is_dark && walk.level > finest;
    let splits = !is_lit && !is_dark && !opens;
    let crossing = crossing_of(bounds, exit);
    let goes_dark = splits && walk.z.y > 0.0;
    // Lit before the crossing where the ray goes away from the light, else from there on.
    let start = select(walk.lit_from, min(walk.lit_from, walk.s), is_lit || goes_dark);
    let run = vec2f(start, select(start, select(walk.s, crossing, goes_dark), !is_lit && !opens));
    let after = select(NOWHERE, crossing, splits && !goes_dark);
    walk.lit_from = select(after, start, is_lit || opens);
    // On into the next square, up a level where that belongs to another parent.
    let by_x = exits.x < exits.y;
    let odd = fract(0.5 * select(square.y, square.x, by_x)) > 0.25;
    let forward = select(walk.ahead.y, walk.ahead.x, by_x) > 0.5;
    let ascends = odd == forward && walk.level < walk.top;
    walk.level = select(walk.level + select(0u, 1u, ascends), walk.level - 1u, opens);
    walk.s = select(exit, walk.s, opens);
    walk.node++;
    return run;
}

// The next lit run, m. Only the walk is in the inner loop: neighbouring rays, which run in step, then
// integrate their runs together.
fn next_run() -> vec2f {
    var run = vec2f(0.0);
    if (walk.s < 1.0) {
        loop {
            run = visit_square();
            if (walk.node >= 4u * walk.max_nodes) { walk.s = 1.0; }
            if (run.y > run.x || walk.s >= 1.0) { break; }
        }
    }
    if (run.y > run.x) {
        return run_between(run.x, run.y);
    }
    walk.s = FINISHED;
    return last_run();
}
