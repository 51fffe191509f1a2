//! use eye_ray
//! use lit_run
//! use depth_bounds

// Squares finer than this are not opened any more once a ray has spent its nodes.
const LAST_LEVEL = 3u;
const FINISHED = 2.0;

fn clip_from_world(is_parallel: bool, view: u32) -> mat4x4f {
    if (is_parallel) {
        return parallel_views[view].clip_from_world;
    }
    return local_views[view].clip_from_world;
}

// The nearest and farthest shadow depth of a square of 2^level texels.
fn shadow_bounds(is_parallel: bool, view: u32, level: u32, square: vec2u) -> vec2f {
    if (is_parallel) {
        if (level == 0u) {
            return vec2f(shadow_depth(textureLoad(parallel_shadows, vec2i(square), view, 0)));
        }
        return parallel_bounds[bounds_index(shafts.parallel_side, view, level, square)];
    }
    if (level == 0u) {
        return vec2f(shadow_depth(textureLoad(local_shadows, vec2i(square), view, 0)));
    }
    return local_bounds[bounds_index(shafts.local_side, view, level, square)];
}

// Narrow `u` to where f + u df >= 0.
fn cut(u: vec2f, f: f32, df: f32) -> vec2f {
    if (df == 0.0) {
        return select(vec2f(1.0, 0.0), u, f >= 0.0);
    }
    let at = -f / df;
    return select(vec2f(u.x, min(u.y, at)), vec2f(max(u.x, at), u.y), df > 0.0);
}

fn cut_sides(u: vec2f, c: vec4f, dc: vec4f) -> vec2f {
    let x = cut(cut(u, c.w + c.x, dc.w + dc.x), c.w - c.x, dc.w - dc.x);
    return cut(cut(x, c.w + c.y, dc.w + dc.y), c.w - c.y, dc.w - dc.y);
}

// The light that one shadow map lets through to the stretch t0..t1 of the eye ray, scattered to
// the eye. The ray is a line over the map: squares that are wholly lit or dark are crossed at
// once, others are opened, and adjacent lit stretches are integrated as one run.
fn view_radiance(
    light: LightData, index: u32, view: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    let is_parallel = light.kind == LIGHT_DIRECTIONAL;
    let resolution = f32(select(shafts.local_resolution, shafts.parallel_resolution, is_parallel));
    let top = select(shafts.local_top, shafts.parallel_top, is_parallel);
    let to_clip = clip_from_world(is_parallel, view);
    let clip0 = to_clip * vec4f(origin + t0 * direction, 1.0);
    let step = to_clip * vec4f((t1 - t0) * direction, 0.0);
    // Outside a sun's map, and before a lamp's near plane, nothing shadows; the rest of space is
    // another map's.
    let sides = cut_sides(vec2f(0.0, 1.0), clip0, step);
    let outer = select(sides, vec2f(0.0, 1.0), is_parallel);
    if (outer.x >= outer.y) {
        return vec3f(0.0);
    }
    let inner = select(cut(sides, clip0.z, step.z), sides, is_parallel);
    let t_outer = t0 + outer * (t1 - t0);
    if (inner.x >= inner.y) {
        return lit_run(light, index, origin, direction, t_outer.x, t_outer.y);
    }
    let t_inner = t0 + inner * (t1 - t0);
    let c0 = clip0 + inner.x * step;
    let c1 = clip0 + inner.y * step;
    let half = vec2f(0.5, -0.5);
    let q0 = (c0.xy / c0.w * half + 0.5) * resolution;
    let dq = (c1.xy / c1.w * half + 0.5) * resolution - q0;
    let z0 = c0.z / c0.w;
    let dz = c1.z / c1.w - z0;
    let inverse = 1.0 / select(dq, vec2f(1e-30), dq == vec2f(0.0));
    let nudge = 1e-3 / max(max(abs(dq.x), abs(dq.y)), 1e-3);
    let w = vec2f(c0.w, c1.w);

    var sum = vec3f(0.0);
    var s = 0.0;
    var level = top;
    var is_lit = outer.x < inner.x;
    var start = t_outer.x;
    for (var node = 0u; s < FINISHED; node++) {
        var run = vec3f(0.0);           // from, to, share
        if (s >= 1.0 || node >= 4u * shafts.max_nodes) {
            let leaves = inner.y < outer.y;
            start = select(t_inner.y, start, is_lit);
            let end = select(t_inner.y, t_outer.y, leaves);
            run = vec3f(start, end, select(0.0, 1.0, (is_lit || leaves) && end > start));
            s = FINISHED;
        } else {
            let size = f32(1u << level);
            let last = vec2f(ceil(resolution / size) - 1.0);
            let square = clamp(floor((q0 + (s + nudge) * dq) / size), vec2f(0.0), last);
            let edge = (square + select(vec2f(0.0), vec2f(1.0), dq > vec2f(0.0))) * size;
            let exits = select((edge - q0) * inverse, vec2f(FINISHED), dq == vec2f(0.0));
            let exit = min(max(min(exits.x, exits.y), s + nudge), 1.0);
            let z = z0 + vec2f(s, exit) * dz;
            let bounds = shadow_bounds(is_parallel, view, level, vec2u(square));
            let near = min(z.x, z.y);
            let far = max(z.x, z.y);
            let t_here = along(s, w, t_inner);
            var is_open = false;
            var is_held = false;
            if (far <= bounds.x) {
                start = select(t_here, start, is_lit);
                is_lit = true;
            } else if (near > bounds.y) {
                run = vec3f(start, t_here, select(0.0, 1.0, is_lit));
                is_lit = false;
            } else if (level == 0u) {
                // The ray passes the depth of one texel: lit before it, or from it on.
                let crossing = clamp((bounds.x - z0) / dz, s, exit);
                let t_cross = along(crossing, w, t_inner);
                if (dz > 0.0) {
                    run = vec3f(select(t_here, start, is_lit), t_cross, 1.0);
                    is_lit = false;
                } else {
                    run = vec3f(start, t_here, select(0.0, 1.0, is_lit));
                    start = t_cross;
                    is_lit = true;
                }
            } else if (node < shafts.max_nodes || level > LAST_LEVEL) {
                is_open = true;
            } else {
                // A run has one share: what was lit ends here, then the square counts in part.
                let high = min(bounds.y, 1.0);
                let share = saturate((high - 0.5 * (near + far)) / max(high - bounds.x, 1e-9));
                is_held = is_lit;
                run = select(vec3f(t_here, along(exit, w, t_inner), share),
                    vec3f(start, t_here, 1.0), is_lit);
                is_lit = false;
            }
            if (is_open) {
                level -= 1u;
            } else if (!is_held) {
                let leaves_x = exits.x < exits.y;
                let coordinate = u32(select(square.y, square.x, leaves_x));
                let forward = select(dq.y, dq.x, leaves_x) > 0.0;
                level += select(0u, 1u, level < top && ((coordinate & 1u) == 1u) == forward);
                s = exit;
            }
        }
        if (run.z > 0.0 && run.y > run.x) {
            sum += run.z * lit_run(light, index, origin, direction, run.x, run.y);
        }
    }
    return sum;
}

// Ray parameter of a share s of the way over the map, in perspective.
fn along(s: f32, w: vec2f, t: vec2f) -> f32 {
    return mix(t.x, t.y, s * w.x / (s * w.x + (1.0 - s) * w.y));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= rays.reduced)) {
        return;
    }
    let ray = picked_ray(rays, id.xy, textureLoad(picked, vec2i(id.xy), 0).xy);
    let hull = visible_hull(air_enter(rays.eye, ray.direction, ray.distance));
    var sum = vec3f(0.0);
    for (var i = 0u; i < shafts.light_count; i++) {
        let light = lights[i];
        var span = hull;
        if (light.kind == LIGHT_SPOT) {
            let cone = ray_cone_interval(
                rays.eye, ray.direction, light.position, light.direction, light.cos_outer);
            span = vec2f(max(span.x, cone.x), min(span.y, cone.y));
        }
        if (span.x < span.y && any(light.color > vec3f(0.0))) {
            run_prepare(light, rays.eye, ray.direction);
            for (var v = 0u; v < light.view_count; v++) {
                sum += view_radiance(
                    light, i, light.first_view + v, rays.eye, ray.direction, span.x, span.y);
            }
        }
    }
    textureStore(scattered, id.xy, vec4f(sum, 1.0));
}

// In one dense medium, no farther than light can come from.
fn visible_hull(hull: vec2f) -> vec2f {
    if (AIR_COUNT > 1u || AIR_GRIDS > 0u) {
        return hull;
    }
    let thinnest = min(air[0].sigma_t.x, min(air[0].sigma_t.y, air[0].sigma_t.z));
    return vec2f(hull.x, min(hull.y, hull.x + 16.0 / max(thinnest, 1e-12)));
}
