// Single scattering along one eye ray, by lit intervals over every shadow map. The including pass binds rays,
// shafts, the lights, their maps and bounds, and the media.
// Interface: the including pass takes lit_interval.wgsl or lit_interval_grids.wgsl (media/shafts/shadow_rays.py).
//! use shadow_walk
//! use light_reach
//! needs fn lit_interval(light: LightData, index: u32, origin: vec3f, direction: vec3f, t0: f32, t1: f32) -> vec3f
//! needs fn media_enter(origin: vec3f, direction: vec3f, reach: f32) -> vec2f
//! needs fn prepare_lit_intervals(light: LightData, origin: vec3f, direction: vec3f)
//! needs fn visible_interval(hull: vec2f) -> vec2f

fn clip_from_world(is_parallel: bool, view: u32) -> mat4x4f {
    if (HAS_DIRECTIONAL && (is_parallel || !HAS_LOCAL)) {
        return row_of_parallel_views(view).clip_from_world;
    }
    return row_of_local_views(view).clip_from_world;
}

fn shadow_word(entry: u32) -> u32 {
    if (HAS_DIRECTIONAL && (walk.is_parallel || !HAS_LOCAL)) {
        return parallel_bounds[entry];
    }
    return local_bounds[entry];
}

// Narrow `u` to where f + u df > 0; or >= 0 where the map has that border.
fn cut(u: vec2f, f: f32, df: f32, has_border: bool) -> vec2f {
    if (df == 0.0) {
        return select(vec2f(1.0, 0.0), u, f > 0.0 || (has_border && f == 0.0));
    }
    let at = -f / df;
    return select(vec2f(u.x, min(u.y, at)), vec2f(max(u.x, at), u.y), df > 0.0);
}

// Of the faces of a cube each border is one's, so that a ray that runs along it is counted once: of +x and -x all, of +y
// and -y those with z (surface/light_views.py: that axis is their y, too). Other maps have all.
fn cut_sides(u: vec2f, c: vec4f, dc: vec4f, face: u32) -> vec2f {
    let has_x = face < 2u;
    let has_y = face < 4u;
    let x = cut(cut(u, c.w + c.x, dc.w + dc.x, has_x), c.w - c.x, dc.w - dc.x, has_x);
    return cut(cut(x, c.w + c.y, dc.w + dc.y, has_y), c.w - c.y, dc.w - dc.y, has_y);
}

// The light that is visible in one shadow map from the interval t0..t1 of the eye ray, scattered to the eye. Squares
// of the map that are wholly lit or dark are crossed at once, others are opened, and adjacent lit intervals are
// integrated as one.
fn view_radiance(
    light: LightData, index: u32, face: u32, to_clip: mat4x4f, direction: vec3f, t0: f32, t1: f32,
) -> vec3f {
    let view = light.first_view + face;
    walk.is_parallel = light.kind == LIGHT_DIRECTIONAL;
    let resolution = f32(
        select(shafts.local_resolution, shafts.parallel_resolution, walk.is_parallel));
    walk.side = select(shafts.local_side, shafts.parallel_side, walk.is_parallel);
    walk.area = walk.side * walk.side;
    walk.first = 2u * view * walk.area;
    walk.rows = firstTrailingBit(walk.side);
    walk.max_nodes = shafts.max_nodes;
    walk.top = select(shafts.local_top, shafts.parallel_top, walk.is_parallel);
    let clip0 = to_clip * vec4f(rays.eye + t0 * direction, 1.0);
    let step = to_clip * vec4f((t1 - t0) * direction, 0.0);
    // Outside the map of a directional light, and before the near plane of a local one, nothing shadows; the rest
    // of space is another map's.
    let sides = cut_sides(vec2f(0.0, 1.0), clip0, step, face);
    let outer = select(sides, vec2f(0.0, 1.0), walk.is_parallel);
    let inner = select(cut(sides, clip0.z, step.z, true), sides, walk.is_parallel);
    var sum = vec3f(0.0);
    if (outer.x >= outer.y) {
        return sum;
    }
    // Where the map has no texels there is one interval, as at the end of a map.
    let is_in = inner.x < inner.y;
    enter_map(clip0, step, outer, select(outer, inner, is_in), t0, t1, resolution);
    walk.s = select(1.0, 0.0, is_in);
    walk.lit_from = select(0.0, walk.lit_from, is_in);
    // Every lit interval from the nearest on; the last is what is lit at the end of the map, and beyond it.
    loop {
        let is_found = find_interval();
        var interval = last_interval();
        if (is_found) {
            interval = found_interval();
        }
        if (interval.y > interval.x) {
            sum += lit_interval(light, index, rays.eye, direction, interval.x, interval.y);
        }
        if (!is_found) { break; }
    }
    return sum;
}

fn light_radiance(light: LightData, index: u32, direction: vec3f, hull: vec2f) -> vec3f {
    let is_parallel = light.kind == LIGHT_DIRECTIONAL;
    var to_clip = clip_from_world(is_parallel, light.first_view);
    prepare_lit_intervals(light, rays.eye, direction);
    let span = light_span(light, rays.eye, direction, hull);
    var sum = vec3f(0.0);
    if (span.x < span.y && any(light.color > vec3f(0.0))) {
        var v = 0u;
        loop {
            sum += view_radiance(
                light, index, v, to_clip, direction, span.x, span.y);
            v++;
            if (!HAS_LOCAL || v >= light.view_count) { break; }
            to_clip = clip_from_world(is_parallel, light.first_view + v);
        }
    }
    return sum;
}

// Radiance towards the eye from light scattered once before `reach`, m. CPU adapters read buffers
// once for all lanes where nothing has branched yet: so a single light is no loop.
fn single_scattered(direction: vec3f, reach: f32) -> vec3f {
    let hull = visible_interval(media_enter(rays.eye, direction, reach));
    if (LIGHT_COUNT == 1u) {
        return light_radiance(row_of_lights(0), 0u, direction, hull);
    }
    var sum = vec3f(0.0);
    var i = 0u;
    loop {
        sum += light_radiance(row_of_lights(i), i, direction, hull);
        i++;
        if (i >= LIGHT_COUNT) { break; }
    }
    return sum;
}
