// A 2D digital differential analyser over a shadow map with bounds on its squares: descends where a
// ray passes between a square's nearest and farthest depth, ascends where it leaves a parent.
// The including pass declares ShaftParams `shafts` and
// fn shadow_bounds(is_parallel: bool, view: u32, level: u32, square: vec2u) -> vec2f.
// Source: Chen et al. 2011 (1D min-max mipmaps), in two dimensions.

// Squares finer than this are not opened any more once a ray has spent its nodes.
const LAST_LEVEL = 3u;
const FINISHED = 2.0;

// One eye ray on its way over one shadow map. It is a line there; s goes from 0 to 1 along it, and
// t is the ray parameter in the world.
struct Walk {
    is_parallel: bool,
    view: u32,
    resolution: f32,    // texels
    top: u32,           // the level that the ray starts at
    q0: vec2f,          // texels, at s = 0
    dq: vec2f,
    inverse: vec2f,     // 1/dq
    z0: f32,            // shadow depth at s = 0
    dz: f32,
    w: vec2f,           // clip w at s = 0 and 1
    t: vec2f,           // m, at s = 0 and 1
    end: f32,           // m, where what lies behind the map's reach ends
    nudge: f32,         // of s, a thousandth of a texel
    s: f32,             // FINISHED at the end
    level: u32,
    node: u32,
    is_lit: bool,
    start: f32,         // m, of the lit run that is under way
}

var<private> walk: Walk;

// Ray parameter at s, in perspective.
fn t_at(s: f32) -> f32 {
    return mix(walk.t.x, walk.t.y, s * walk.w.x / (s * walk.w.x + (1.0 - s) * walk.w.y));
}

// Lay the stretch t0..t1 of the eye ray over a map. `outer` is the share of it that is this map's
// affair, `inner` where the map has texels; between them nothing shadows.
fn enter_map(
    clip0: vec4f, step: vec4f, outer: vec2f, inner: vec2f, t0: f32, t1: f32,
) {
    let c0 = clip0 + inner.x * step;
    let c1 = clip0 + inner.y * step;
    let half = vec2f(0.5, -0.5);
    walk.q0 = (c0.xy / c0.w * half + 0.5) * walk.resolution;
    walk.dq = (c1.xy / c1.w * half + 0.5) * walk.resolution - walk.q0;
    walk.inverse = 1.0 / select(walk.dq, vec2f(1e-30), walk.dq == vec2f(0.0));
    walk.z0 = c0.z / c0.w;
    walk.dz = c1.z / c1.w - walk.z0;
    walk.w = vec2f(c0.w, c1.w);
    walk.t = t0 + inner * (t1 - t0);
    walk.end = t0 + outer.y * (t1 - t0);
    walk.nudge = 1e-3 / max(max(abs(walk.dq.x), abs(walk.dq.y)), 1e-3);
    walk.s = 0.0;
    walk.level = walk.top;
    walk.node = 0u;
    walk.is_lit = outer.x < inner.x;
    walk.start = t0 + outer.x * (t1 - t0);
}

// What is lit at the end of the map, and beyond it.
fn last_run() -> vec2f {
    walk.s = FINISHED;
    let start = select(walk.t.y, walk.start, walk.is_lit);
    return vec2f(start, select(walk.t.y, walk.end, walk.t.y < walk.end));
}

// The run that was lit up to here, if any.
fn closed_run(t: f32) -> vec2f {
    let run = vec2f(walk.start, select(walk.start, t, walk.is_lit));
    walk.is_lit = false;
    return run;
}

// The ray is lit in a part of a square: before `crossing` where it goes away from the light, else
// from there on.
fn split_run(t: f32, crossing: f32) -> vec2f {
    let t_cross = t_at(crossing);
    if (walk.dz > 0.0) {
        walk.start = select(t, walk.start, walk.is_lit);
        walk.is_lit = true;
        return closed_run(t_cross);
    }
    let run = closed_run(t);
    walk.start = t_cross;
    walk.is_lit = true;
    return run;
}

// Where the ray passes the depth of one texel; of a larger square, so that its lit share fits.
fn crossing_of(bounds: vec2f, z: vec2f, exit: f32) -> f32 {
    if (walk.level == 0u) {
        return clamp((bounds.x - walk.z0) / walk.dz, walk.s, exit);
    }
    let high = min(bounds.y, 1.0);
    let share = saturate((high - 0.5 * (z.x + z.y)) / max(high - bounds.x, 1e-9));
    return mix(walk.s, exit, select(1.0 - share, share, walk.dz > 0.0));
}

// Squares up to this level are not opened: when the ray has spent its nodes, whatever is left.
fn finest_level() -> u32 {
    return select(0u, LAST_LEVEL, walk.node >= shafts.max_nodes);
}

// On into the next square, up a level where that belongs to another parent.
fn leave_square(square: vec2f, exits: vec2f, exit: f32) {
    let by_x = exits.x < exits.y;
    let coordinate = u32(select(square.y, square.x, by_x));
    let forward = select(walk.dq.y, walk.dq.x, by_x) > 0.0;
    let ascends = walk.level < walk.top && ((coordinate & 1u) == 1u) == forward;
    walk.level += select(0u, 1u, ascends);
    walk.s = exit;
}

// Cross or open one square; returns the lit run that ends in it, if any.
fn visit_square() -> vec2f {
    let size = f32(1u << walk.level);
    let last = vec2f(ceil(walk.resolution / size) - 1.0);
    let place = (walk.q0 + (walk.s + walk.nudge) * walk.dq) / size;
    let square = clamp(floor(place), vec2f(0.0), last);
    let edge = (square + select(vec2f(0.0), vec2f(1.0), walk.dq > vec2f(0.0))) * size;
    let exits = select((edge - walk.q0) * walk.inverse, vec2f(FINISHED), walk.dq == vec2f(0.0));
    let exit = min(max(min(exits.x, exits.y), walk.s + walk.nudge), 1.0);
    let z = walk.z0 + vec2f(walk.s, exit) * walk.dz;
    let bounds = shadow_bounds(walk.is_parallel, walk.view, walk.level, vec2u(square));
    let t = t_at(walk.s);
    var run = vec2f(0.0);
    if (max(z.x, z.y) <= bounds.x) {
        walk.start = select(t, walk.start, walk.is_lit);
        walk.is_lit = true;
    } else if (min(z.x, z.y) > bounds.y) {
        run = closed_run(t);
    } else if (walk.level > finest_level()) {
        walk.level -= 1u;
        return run;
    } else {
        run = split_run(t, crossing_of(bounds, z, exit));
    }
    leave_square(square, exits, exit);
    return run;
}

// The next lit run. Only the walk is in the inner loop: neighbouring rays, which run in step, then
// integrate their runs together.
fn next_run() -> vec2f {
    var run = vec2f(0.0);
    loop {
        if (walk.s >= 1.0 || walk.node >= 4u * shafts.max_nodes) {
            run = last_run();
        } else {
            run = visit_square();
            walk.node++;
        }
        if (walk.s >= FINISHED || run.y > run.x) { break; }
    }
    return run;
}
