// The light of gather points, shared with neighbours on about the same plane: each kind of light with weights of its own
// (docs/techniques/gather.md, "Sharing"). Source: Dammertz2010 (edge-avoiding a-trous wavelets), whose steps double from
// pass to pass.
//! use gather
//! use orphans
//! use point_sums
//! use stored_sums
//! use tone

struct Point {
    place: vec4f,           // m; w: from the eye, 0 where there is no surface
    normal: vec3f,
    sums: PointSums,
    sky: vec2f,             // luminance of its light there, and the variance of that
}

// How far the light of a neighbour stands for that of a point: of near surfaces, of far ones, what near surfaces reflect
// of later segments' light, and of the sky. Or the sums of such weights.
struct Weights {
    near: f32,
    far: f32,
    later: f32,
    sky: f32,
}

struct Shared {
    sums: PointSums,        // weighted
    total: Weights,
}

// Luminance of the sky's light in a point's sums, and its variance: of the first pass's sums by their squares, and by
// the frames before that are in them.
fn sky_noise(sums: PointSums) -> vec2f {
    let sum = luminance(sums.sky);
    let rays = params.rays + params.sky_rays;
    let found = variance_of_sum(sum, sums.sky_variance, rays) / (1.0 + sums.frames);
    return vec2f(sum, select(sums.sky_variance, found, params.stride == 1u));
}

fn point_at(texel: vec2i) -> Point {
    let sums = sums_at(before, vec2u(texel));
    return Point(textureLoad(places, texel, 0), textureLoad(planes, texel, 0).xyz, sums, sky_noise(sums));
}

// The third factor of what near surfaces send: by the mean of `nearness` over the rays of both points.
fn closeness_of(one: PointSums, other: PointSums, offset: vec3f) -> f32 {
    // Rays that met nothing say nothing of how surfaces' light changes, and few rays that met some not much.
    let each = 1.0 / max(one.met_rays + other.met_rays, 2.0 * FEWEST * f32(params.rays));
    return closeness(offset, each * (one.squares + other.squares), each * (one.products + other.products));
}

// The last factors of light from afar: as far as its own rays are long, and no wall is between both points.
fn far_closeness_of(one: PointSums, other: PointSums, offset: vec3f) -> f32 {
    // Beside the rays of both, one ray at whose length far begins.
    let inverse_m = (one.far_inverse_m + other.far_inverse_m + one.far_begins) / (one.far_rays + other.far_rays + 1.0);
    return far_closeness(offset, inverse_m, one.sides / max(one.met_rays, 1.0), other.sides / max(other.met_rays, 1.0));
}

// `faded`: by how many steps the other is away; `texel_m`: how wide such a step is.
fn weights_of(own: Point, its: Point, faded: f32, texel_m: f32) -> Weights {
    let offset = its.place.xyz - own.place.xyz;
    let like = likeness(own.place.xyz, own.normal, its.place.xyz, its.normal, texel_m);
    let close = closeness_of(own.sums, its.sums, offset);
    let far_close = far_closeness_of(own.sums, its.sums, offset);
    var w: Weights;
    w.near = faded * like * close;
    // Light from afar is the same off the plane, too.
    w.far = faded * far_likeness(like, own.normal, its.normal) * far_close;
    // From twice as far as what lights shine on near surfaces.
    w.later = faded * like * far_close * sqrt(sqrt(close));
    // Of the sky, what is no noise but the edge of a shadow stays.
    w.sky = w.near * sameness(own.sky.x, its.sky.x, own.sky.y + its.sky.y);
    return w;
}

// `so_far`, and of a neighbour each kind of light with its weight.
fn with_neighbour(so_far: Shared, other: Point, w: Weights) -> Shared {
    var out = so_far;
    let its = other.sums;
    // Near surfaces: what lights shine on them, and how near they are.
    out.sums.near += w.near * its.near;
    out.sums.far_share += w.near * its.far_share;
    out.sums.near_flux += w.near * its.near_flux;
    out.sums.open += w.near * its.open;
    out.sums.squares += w.near * its.squares;
    out.sums.met_rays += w.near * its.met_rays;
    out.sums.products += w.near * its.products;
    out.sums.sides += w.near * its.sides;
    out.total.near += w.near;
    // Far surfaces.
    out.sums.far += w.far * its.far;
    out.sums.far_rays += w.far * its.far_rays;
    out.sums.far_flux += w.far * its.far_flux;
    out.sums.far_inverse_m += w.far * its.far_inverse_m;
    out.total.far += w.far;
    // What near surfaces reflect of later segments' light.
    out.sums.later += w.later * its.later;
    out.sums.later_rays += w.later * its.later_rays;
    out.sums.later_flux += w.later * its.later_flux;
    out.total.later += w.later;
    // The sky, and the variance of its mean.
    out.sums.sky += w.sky * its.sky;
    out.sums.sky_flux += w.sky * its.sky_flux;
    out.sums.sky_variance += w.sky * w.sky * other.sky.y;
    out.total.sky += w.sky;
    return out;
}

fn inverse_of(total: f32) -> f32 {
    return select(0.0, 1.0 / total, total > 0.0);
}

// Weighted sums over their weights.
fn mean_of(so_far: Shared) -> PointSums {
    var out = so_far.sums;
    // Near surfaces, far ones, those met later and the sky were weighted apart.
    let near = inverse_of(so_far.total.near);
    out.near *= near;
    out.far_share *= near;
    out.near_flux *= near;
    out.open *= near;
    out.squares *= near;
    out.met_rays *= near;
    out.products *= near;
    out.sides *= near;
    let far = inverse_of(so_far.total.far);
    out.far *= far;
    out.far_rays *= far;
    out.far_flux *= far;
    out.far_inverse_m *= far;
    let later = inverse_of(so_far.total.later);
    out.later *= later;
    out.later_rays *= later;
    out.later_flux *= later;
    let sky = inverse_of(so_far.total.sky);
    out.sky *= sky;
    out.sky_flux *= sky;
    out.sky_variance = out.sky_variance * sky * sky;
    return out;
}

// With the light of all surfaces in `near`: mean radiances, of far surfaces and of what near ones reflect, for as many
// rays as met such.
fn put_together(sums: PointSums) -> PointSums {
    var out = sums;
    let far_share = sums.far_share / max(sums.far_rays, 1e-3);
    let later_share = max(sums.met_rays - sums.far_share, 0.0) / max(sums.later_rays, 1e-3);
    out.near += far_share * sums.far;
    out.near_flux += far_share * sums.far_flux;
    out.near += later_share * sums.later;
    out.near_flux += later_share * sums.later_flux;
    return out;
}

// Offset of the k-th of the thirteen texels at most two steps away: every other one of 5 x 5 texels, turned by 45 degrees.
fn neighbour(k: i32) -> vec2i {
    let diagonal = vec2i((2 * k) % 5, (2 * k) / 5) - 2;
    return vec2i(diagonal.x + diagonal.y, diagonal.x - diagonal.y) / 2;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.rows) {
        return;
    }
    let own = point_at(vec2i(id.xy));
    let block = vec2i(block_of(id.xy));
    // As in later samples of a still.
    let falloff = params.falloff * sqrt(1.0 + own.sums.frames);
    let texel_m = params.texel * max(own.place.w, 1e-9) * f32(params.stride);
    let last = vec2i(params.reduced) - 1;
    // Thirteen neighbours, two steps away at most, of which each kind of light has weights of its own.
    var sum: Shared;
    var k = 0;
    loop {
        if (own.place.w <= 0.0) { break; }
        let offset = neighbour(k);
        let at = block + offset * i32(params.stride);
        if (all(at >= vec2i(0)) && all(at <= last)) {
            // The block's point, and those of its orphans.
            let faded = exp(-falloff * f32(dot(offset, offset)));
            let orphans = orphans_of(vec2u(at));
            var texel = vec2u(at);
            var next = orphans.first;
            loop {
                let its = point_at(vec2i(texel));
                let counts = select(0.0, faded, its.place.w > 0.0);
                sum = with_neighbour(sum, its, weights_of(own, its, counts, texel_m));
                if (next >= orphans.end) { break; }
                texel = orphan_texel(next);
                next++;
            }
        }
        k++;
        if (k >= 13) { break; }
    }
    var mean = mean_of(sum);
    if (params.is_last != 0u) {
        mean = put_together(mean);
    }
    mean.frames = own.sums.frames;
    mean.far_begins = own.sums.far_begins;
    store_sums(id.xy, mean);
}
