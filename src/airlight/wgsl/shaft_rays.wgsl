// Single scattering along one eye ray, by lit runs over every shadow map. The including pass binds
// rays, shafts, the lights, their maps and bounds, and the air.
//! use eye_ray
//! use shadow_levels
//! use shadow_walk

fn clip_from_world(is_parallel: bool, view: u32) -> mat4x4f {
    if (HAS_SUNS && (is_parallel || !HAS_LAMPS)) {
        return parallel_views[view].clip_from_world;
    }
    return local_views[view].clip_from_world;
}

// The nearest and farthest shadow depth of a square of 2^level texels.
fn shadow_bounds(level: u32, square: vec2u) -> vec2f {
    let entry = level_entry(walk.side, walk.view, level, square);
    if (HAS_SUNS && (walk.is_parallel || !HAS_LAMPS)) {
        return level_bounds(parallel_bounds[entry], level, square);
    }
    return level_bounds(local_bounds[entry], level, square);
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
// the eye. Squares of the map that are wholly lit or dark are crossed at once, others are opened,
// and adjacent lit stretches are integrated as one run.
fn view_radiance(
    light: LightData, index: u32, view: u32, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    walk.is_parallel = light.kind == LIGHT_DIRECTIONAL;
    walk.view = view;
    let resolution = f32(
        select(shafts.local_resolution, shafts.parallel_resolution, walk.is_parallel));
    walk.side = select(shafts.local_side, shafts.parallel_side, walk.is_parallel);
    walk.max_nodes = shafts.max_nodes;
    walk.top = select(shafts.local_top, shafts.parallel_top, walk.is_parallel);
    let to_clip = clip_from_world(walk.is_parallel, view);
    let clip0 = to_clip * vec4f(rays.eye + t0 * direction, 1.0);
    let step = to_clip * vec4f((t1 - t0) * direction, 0.0);
    // Outside a sun's map, and before a lamp's near plane, nothing shadows; the rest of space is
    // another map's.
    let sides = cut_sides(vec2f(0.0, 1.0), clip0, step);
    let outer = select(sides, vec2f(0.0, 1.0), walk.is_parallel);
    let inner = select(cut(sides, clip0.z, step.z), sides, walk.is_parallel);
    var sum = vec3f(0.0);
    if (outer.x >= outer.y) {
        return sum;
    }
    // Where the map has no texels there is one run, as at the end of a map.
    let is_in = inner.x < inner.y;
    enter_map(clip0, step, outer, select(outer, inner, is_in), t0, t1, resolution);
    walk.s = select(1.0, 0.0, is_in);
    walk.lit_from = select(0.0, walk.lit_from, is_in);
    loop {
        let run = next_run();
        if (run.y > run.x) {
            sum += lit_run(light, index, rays.eye, direction, run.x, run.y);
        }
        if (walk.s >= FINISHED) { break; }
    }
    return sum;
}

// Radiance towards the eye from light scattered once before `reach`, m.
fn single_scattered(direction: vec3f, reach: f32) -> vec3f {
    let hull = visible_hull(air_enter(rays.eye, direction, reach));
    var sum = vec3f(0.0);
    var i = 0u;
    loop {
        let light = lights[i];
        let span = light_span(light, rays.eye, direction, hull);
        if (span.x < span.y && any(light.color > vec3f(0.0))) {
            run_prepare(light, rays.eye, direction);
            var v = 0u;
            loop {
                sum += view_radiance(light, i, light.first_view + v, direction, span.x, span.y);
                v++;
                if (!HAS_LAMPS || v >= light.view_count) { break; }
            }
        }
        i++;
        if (i >= shafts.light_count) { break; }
    }
    return sum;
}
