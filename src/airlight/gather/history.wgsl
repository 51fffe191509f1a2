// The light of gather points with what they found in the frames before: looked up where the camera saw their places
// then, where the same surface was there. Source: Schied2017 (temporal accumulation by moments of its length), at points.
//! use gather
//! use gather_history
//! use orphans
//! use point_sums
//! use stored_sums
//! use tone

// A place in the image of a camera, in texels from the middle of the first; w: whether it is before the eye.
fn texel_of(clip_from_world: mat4x4f, place: vec3f) -> vec3f {
    let clip = clip_from_world * vec4f(place, 1.0);
    let ndc = clip.xy / max(clip.w, 1e-9);
    let pixel = vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * params.size;
    return vec3f(pixel / f32(params.scale) - 0.5, f32(clip.w > 0.0));
}

// What was found before, and for how many frames it counts.
struct Before {
    sums: PointSums,
    frames: f32,
}

// a + weight * b, of all that is added up for a point.
fn plus(a: PointSums, weight: f32, b: PointSums) -> PointSums {
    var out = a;
    out.near += weight * b.near;
    out.far_share += weight * b.far_share;
    out.near_flux += weight * b.near_flux;
    out.open += weight * b.open;
    out.far += weight * b.far;
    out.far_rays += weight * b.far_rays;
    out.far_flux += weight * b.far_flux;
    out.far_inverse_m += weight * b.far_inverse_m;
    out.later += weight * b.later;
    out.later_rays += weight * b.later_rays;
    out.later_flux += weight * b.later_flux;
    out.far_begins += weight * b.far_begins;
    out.sky += weight * b.sky;
    out.sky_variance += weight * b.sky_variance;
    out.sky_flux += weight * b.sky_flux;
    out.squares += weight * b.squares;
    out.met_rays += weight * b.met_rays;
    out.products += weight * b.products;
    out.sides += weight * b.sides;
    return out;
}

fn found_before(texel: vec2u, place: vec4f, n: vec3f) -> Before {
    var out: Before;
    let then = texel_of(params.before_from_world, place.xyz);
    // Points lie anywhere in their blocks, but stand for all of them.
    let within = texel_of(params.clip_from_world, place.xyz).xy - vec2f(texel);
    let at = then.xy - within;
    let last = vec2i(params.reduced) - 1;
    let texel_m = params.texel * place.w;
    var sum: PointSums;
    var total = 0.0;
    var best = 0.0;
    var k = 0;
    loop {
        if (then.z <= 0.0) { break; }
        // Each of the nine, by its distance in the image and its likeness.
        let other = vec2i(round(at)) + vec2i(k % 3, k / 3) - 1;
        if (all(other >= vec2i(0)) && all(other <= last)) {
            // The block's point, and those of its orphans.
            var at_other = vec2u(other);
            let orphans = orphan_run(places_before[at_other.y * params.reduced.x + at_other.x].orphans);
            var next = orphans.first;
            loop {
                let its = places_before[at_other.y * params.reduced.x + at_other.x];
                var like = likeness(place.xyz, n, its.place, its.normal, texel_m);
                like = select(0.0, like, its.frames > 0.0);
                let weight = like * texel_share(vec2f(other) - at);
                sum = plus(sum, weight, sums_at(sums_before, at_other));
                out.frames += weight * its.frames;
                total += weight;
                best = max(best, like);
                if (next >= orphans.end) { break; }
                at_other = orphan_texel(next);
                next++;
            }
        }
        k++;
        if (k > 8) { break; }
    }
    let inverse = select(0.0, 1.0 / total, total > 1e-9);
    out.sums = plus(PointSums(), inverse, sum);
    out.frames = frames_kept(out.frames * inverse, best, params.most);
    return out;
}

// This frame's light around a point: the mean and the variance of that mean, of channels and of their luminance.
struct Around {
    surfaces: vec3f,
    sky: vec3f,
    light: f32,
    surfaces_variance: vec3f,
    sky_variance: vec3f,
    light_variance: f32,
}

fn light_around(texel: vec2u, place: vec4f, n: vec3f) -> Around {
    var out: Around;
    let last = vec2i(params.reduced) - 1;
    let texel_m = params.texel * place.w;
    var total = 0.0;
    var squared = 0.0;
    var k = 0;
    loop {
        let other = vec2i(texel) + vec2i(k % 5, k / 5) - 2;
        if (all(other >= vec2i(0)) && all(other <= last)) {
            var at = vec2u(other);
            let orphans = orphans_of(at);
            var next = orphans.first;
            loop {
                // Whatever a like neighbour has, in sums of its light and of the squares.
                let its = textureLoad(places, at, 0);
                let like = likeness(place.xyz, n, its.xyz, textureLoad(planes, at, 0).xyz, texel_m);
                let weight = select(0.0, like, its.w > 0.0);
                let found = sums_at(sums, at);
                let surfaces = found.near + found.far + found.later;
                let sky = found.sky;
                let light = luminance(surfaces + sky);
                out.surfaces += weight * surfaces;
                out.sky += weight * sky;
                out.light += weight * light;
                out.surfaces_variance += weight * surfaces * surfaces;
                out.sky_variance += weight * sky * sky;
                out.light_variance += weight * light * light;
                total += weight;
                squared += weight * weight;
                if (next >= orphans.end) { break; }
                at = orphan_texel(next);
                next++;
            }
        }
        k++;
        if (k > 24) { break; }
    }
    // The variance of the weighted mean: that of one, by the effective number of neighbours.
    let inverse = 1.0 / max(total, 1e-9);
    let of_mean = squared * inverse * inverse;
    out.surfaces *= inverse;
    out.sky *= inverse;
    out.light *= inverse;
    out.surfaces_variance = of_mean * (inverse * out.surfaces_variance - out.surfaces * out.surfaces);
    out.sky_variance = of_mean * (inverse * out.sky_variance - out.sky * out.sky);
    out.light_variance = of_mean * (inverse * out.light_variance - out.light * out.light);
    return out;
}

fn all_followed(before: vec3f, mean: vec3f, variance: vec3f) -> vec3f {
    return vec3f(followed(before.r, mean.r, variance.r), followed(before.g, mean.g, variance.g),
        followed(before.b, mean.b, variance.b));
}

// `before`, brought as near to this frame's light as its noise says, and for fewer frames.
fn following(before: Before, around: Around) -> Before {
    var out = before;
    // Light of near surfaces and of far ones, together.
    let lit = before.sums.near + before.sums.far + before.sums.later;
    let surfaces = all_followed(lit, around.surfaces, around.surfaces_variance);
    let share = surfaces / max(lit, vec3f(1e-20));
    let ratio = luminance(surfaces) / max(luminance(lit), 1e-20);
    // Where there was none, all of it is near by.
    out.sums.near = select(share * before.sums.near, surfaces, lit <= vec3f(0.0));
    out.sums.near_flux *= ratio;
    out.sums.far *= share;
    out.sums.far_flux *= ratio;
    out.sums.later *= share;
    out.sums.later_flux *= ratio;
    // The sky's.
    let sky = all_followed(before.sums.sky, around.sky, around.sky_variance);
    let sky_ratio = luminance(sky) / max(luminance(before.sums.sky), 1e-20);
    out.sums.sky = sky;
    out.sums.sky_flux *= sky_ratio;
    out.sums.sky_variance *= sky_ratio * sky_ratio;
    let light = luminance(lit + before.sums.sky);
    out.frames = frames_believed(before.frames, light, around.light, around.light_variance);
    return out;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.rows) {
        return;
    }
    let block = block_of(id.xy);
    let place = textureLoad(places, id.xy, 0);
    let n = textureLoad(planes, id.xy, 0).xyz;
    let index = id.y * params.reduced.x + id.x;
    var before: Before;
    if (place.w > 0.0 && params.most > 0.0) {
        before = found_before(block, place, n);
        if (params.is_changing != 0u) {
            before = following(before, light_around(block, place, n));
        }
    }
    // The mean over frames of what was found before and of what this frame has.
    let share = 1.0 / (before.frames + 1.0);
    var mean = plus(plus(PointSums(), 1.0 - share, before.sums), share, sums_at(sums, id.xy));
    // Filters narrow as frames add up, as they do in later samples of a still.
    mean.frames = before.frames;
    store_sums(id.xy, mean);
    let frames = select(0.0, before.frames + 1.0, place.w > 0.0);
    places_after[index] = PlaceBefore(place.xyz, frames, n, orphans[index]);
}
