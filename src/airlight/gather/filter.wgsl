// The light of gather points, shared with neighbours on about the same plane; the sky's where it does not differ by more
// than its noise, light from afar and what near surfaces reflect of it with more of them. Source: Dammertz2010
// (edge-avoiding a-trous wavelets), whose steps double from pass to pass.
//! use gather

// The least share of a point's rays that how near surfaces are is the mean of.
const FEWEST = 0.125;

// Luminance of the sky's light in a point's sums, and its variance: of the first pass's sums by their squares, and by
// the frames before that are in them.
fn noisy(light: vec4f, frames: f32) -> vec2f {
    let sum = luminance(light.rgb);
    let found = variance_of_sum(sum, light.w, params.rays + params.sky_rays) / (1.0 + frames);
    return vec2f(sum, select(light.w, found, params.stride == 1u));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let place = textureLoad(places, id.xy, 0);
    let n = textureLoad(planes, id.xy, 0).xyz;
    let own = SUMS * (id.y * params.reduced.x + id.x);
    let frames = before[own + 3u].w;
    let own_sky = noisy(before[own + 1u], frames);
    // As in later samples of a still.
    let falloff = params.falloff * sqrt(1.0 + frames);
    var surfaces = vec4f(0.0);
    var sky = vec4f(0.0);
    var flux = vec4f(0.0);
    var sky_flux = vec4f(0.0);
    var squares = vec4f(0.0);
    var products = vec4f(0.0);
    var sides = vec4f(0.0);
    var variance = 0.0;
    var from_afar = vec4f(0.0);
    var flux_from_afar = vec4f(0.0);
    var later = vec4f(0.0);
    var later_flux = vec4f(0.0);
    var total = 0.0;
    var far_total = 0.0;
    var later_total = 0.0;
    var sky_total = 0.0;
    let texel_m = params.texel * max(place.w, 1e-9) * f32(params.stride);
    let own_squares = before[own + 4u];
    let own_products = before[own + 5u].xyz;
    let own_sides = before[own + 8u];
    let own_far = vec2f(before[own + 6u].w, before[own + 7u].w);
    let last = vec2i(params.reduced) - 1;
    var k = 0;
    loop {
        if (place.w <= 0.0) { break; }
        let offset = vec2i(k % 5, k / 5) - 2;
        let at = vec2i(id.xy) + offset * i32(params.stride);
        if (all(at >= vec2i(0)) && all(at <= last)) {
            let other = textureLoad(places, at, 0);
            let its = textureLoad(planes, at, 0).xyz;
            let index = SUMS * (u32(at.y) * params.reduced.x + u32(at.x));
            let its_light = before[index];
            let its_sky = before[index + 1u];
            let its_squares = before[index + 4u];
            let its_products = before[index + 5u];
            let its_far = before[index + 6u];
            let its_far_flux = before[index + 7u];
            let its_sides = before[index + 8u];
            let faded = select(0.0, exp(-falloff * f32(dot(offset, offset))), other.w > 0.0);
            let like = likeness(place.xyz, n, other.xyz, its, texel_m);
            // Rays that met nothing say nothing of how surfaces' light changes, and few rays that met some not much.
            let met = own_squares.w + its_squares.w;
            let each = 1.0 / max(met, 2.0 * FEWEST * f32(params.rays));
            let way = other.xyz - place.xyz;
            let close = closeness(way, each * (own_squares + its_squares).xyz,
                each * (own_products + its_products.xyz));
            var weight = faded * like * close;
            surfaces += weight * its_light;
            flux += weight * before[index + 2u];
            squares += weight * its_squares;
            products += weight * its_products;
            sides += weight * its_sides;
            total += weight;
            // Light from afar is the same off the plane, too, and as far as its own rays are long.
            let far_m = (own_far.y + its_far_flux.w + own_sides.w) / (own_far.x + its_far.w + 1.0);
            let far_close = far_closeness(way, far_m, own_sides.xyz / max(own_squares.w, 1.0),
                its_sides.xyz / max(its_squares.w, 1.0));
            let far_weight = faded * far_likeness(like, n, its) * far_close;
            from_afar += far_weight * its_far;
            flux_from_afar += far_weight * its_far_flux;
            far_total += far_weight;
            // What near surfaces reflect of later segments' light, from twice as far as what lights shine on them.
            let later_weight = faded * like * far_close * sqrt(sqrt(close));
            later += later_weight * before[index + 9u];
            later_flux += later_weight * before[index + 10u];
            later_total += later_weight;
            // Of the sky, what is no noise but the edge of a shadow stays.
            let other_sky = noisy(its_sky, before[index + 3u].w);
            weight *= sameness(own_sky.x, other_sky.x, own_sky.y + other_sky.y);
            sky += weight * its_sky;
            sky_flux += weight * before[index + 3u];
            variance += weight * weight * other_sky.y;
            sky_total += weight;
        }
        k++;
        if (k >= 25) { break; }
    }
    let inverse = select(0.0, 1.0 / total, total > 0.0);
    let sky_inverse = select(0.0, 1.0 / sky_total, sky_total > 0.0);
    let far_inverse = select(0.0, 1.0 / far_total, far_total > 0.0);
    let later_inverse = select(0.0, 1.0 / later_total, later_total > 0.0);
    surfaces *= inverse;
    flux *= inverse;
    from_afar *= far_inverse;
    flux_from_afar *= far_inverse;
    later *= later_inverse;
    later_flux *= later_inverse;
    // Together: mean radiances, of far surfaces and of what near ones reflect, for as many rays as met such.
    if (params.is_last != 0u) {
        let share = surfaces.w / max(from_afar.w, 1e-3);
        surfaces += share * vec4f(from_afar.rgb, 0.0);
        flux += share * vec4f(flux_from_afar.xyz, 0.0);
        let later_share = max(squares.w * inverse - surfaces.w, 0.0) / max(later.w, 1e-3);
        surfaces += later_share * vec4f(later.rgb, 0.0);
        flux += later_share * vec4f(later_flux.xyz, 0.0);
    }
    after[own] = surfaces;
    after[own + 1u] = vec4f(sky.rgb * sky_inverse, variance * sky_inverse * sky_inverse);
    after[own + 2u] = flux;
    after[own + 3u] = vec4f(sky_flux.xyz * sky_inverse, frames);
    after[own + 4u] = squares * inverse;
    after[own + 5u] = products * inverse;
    after[own + 6u] = from_afar;
    after[own + 7u] = flux_from_afar;
    after[own + 8u] = vec4f(sides.xyz * inverse, own_sides.w);
    after[own + 9u] = later;
    after[own + 10u] = later_flux;
}
