// Which rays a gather point sends, and how far its neighbours' rays stand for its own: the twin of
// maths/gather.py, which says where the numbers come from.
//! use phase
//! use sampling

const NORMAL_POWER = 8.0;
const PLANE_SHARE = 0.0025;
const REACH = 0.1;
const LEAST_RAY = 3.0;
const ALONG = 0.25;
const FAR = 24.0;
const FAR_POWER = 32.0;
const THROUGH = 0.15;
const LEAST_SIDE = 0.5;
const SAME = 0.02;
const DOUBT = 4.0;
const LEAST_COSINE = 0.1;
const TRUST = 0.1;
const MOST_DETAIL = 4.0;
const FEWEST = 0.125;       // the least share of a point's rays that how near surfaces are is the mean of
const CALIBRATION_DOUBT = 0.3;
const MOST_CALIBRATION = 4.0;

fn ray_numbers(x: u32, y: u32, ray: u32) -> vec2f {
    let first = x * 3679390609u + y * 3152041523u + ray * 3242174889u;
    let second = x * 2700274807u + y * 2313257605u + ray * 2447445413u;
    return vec2f(uniform_from_hash(first), uniform_from_hash(second));
}

fn later_numbers(x: u32, y: u32, ray: u32, segment: u32) -> vec2f {
    let first = x * 1013904242u + y * 1359893119u + ray * 1779033703u;
    let second = x * 2773480762u + y * 2600822924u + ray * 3144134277u;
    let mixed = pcg_hash(x + pcg_hash(y + pcg_hash(ray + pcg_hash(segment))));
    let numbers = select(vec2u(mixed, pcg_hash(mixed + 1u)), vec2u(first, second), segment < 2u);
    return vec2f(uniform_from_hash(numbers.x), uniform_from_hash(numbers.y));
}

fn cosine_direction(normal: vec3f, numbers: vec2f) -> vec3f {
    let radius = sqrt(numbers.x);
    let angle = 6.2831853 * numbers.y;
    let z = sqrt(max(1.0 - numbers.x, 0.0));
    return orthonormal_frame(normal) * vec3f(radius * cos(angle), radius * sin(angle), z);
}

fn sphere_direction(numbers: vec2f) -> vec3f {
    let z = 1.0 - 2.0 * numbers.x;
    let radius = sqrt(max(1.0 - z * z, 0.0));
    let angle = 6.2831853 * numbers.y;
    return vec3f(radius * cos(angle), radius * sin(angle), z);
}

fn lobe_direction(axis: vec3f, g: f32, numbers: vec2f) -> vec3f {
    let is_lobe = numbers.x >= 0.5;
    let again = vec2f(2.0 * numbers.x - select(0.0, 1.0, is_lobe), numbers.y);
    let is_flat = abs(g) < 1e-3;
    let safe = select(g, 1.0, is_flat);
    let square = (1.0 - safe * safe) / (1.0 + safe - 2.0 * safe * again.x);
    let bent = (1.0 + safe * safe - square * square) / (2.0 * safe);
    let z = clamp(select(bent, 1.0 - 2.0 * again.x, is_flat), -1.0, 1.0);
    let radius = sqrt(1.0 - z * z);
    let angle = 6.2831853 * again.y;
    let lobe = orthonormal_frame(axis) * vec3f(radius * cos(angle), radius * sin(angle), z);
    return select(sphere_direction(again), lobe, is_lobe);
}

fn lobe_density(cosine: f32, g: f32) -> f32 {
    return 0.5 * (PHASE_ISOTROPIC + henyey_greenstein(cosine, g));
}

fn flux_along(normal: vec3f, direction: vec3f) -> vec3f {
    let cosine = dot(direction, normal);
    return normal + (direction - cosine * normal) / max(cosine, LEAST_COSINE);
}

fn likeness(place: vec3f, normal: vec3f, other: vec3f, its_normal: vec3f, texel_m: f32) -> f32 {
    let cosine = saturate(dot(normal, its_normal));
    let bend = distance(other, place) * sqrt(0.5 - 0.5 * cosine) * saturate(25.0 * cosine - 23.5);
    let off = max(abs(dot(other - place, normal)) - bend, 0.0) / (PLANE_SHARE * texel_m);
    return pow(cosine, NORMAL_POWER) * exp(-off);
}

fn sky_share(cosine: f32, density: f32, rays: u32, sky_rays: u32) -> f32 {
    let by_cosine = f32(rays) * max(cosine, 0.0) / 3.14159265;
    return by_cosine / max(by_cosine + f32(sky_rays) * density, 1e-30);
}

fn turn_ratio(flux: vec3f, normal: vec3f) -> f32 {
    let follows = max(1.0 - 0.5 / max(dot(flux, flux), 1e-20), 0.0);
    return max(mix(1.0, dot(flux, normal), follows), 0.0);
}

fn detailed(gathered: vec3f, around: vec3f, own: vec3f) -> vec3f {
    let trust = TRUST * gathered;
    let ratio = (own + trust) / max(around + trust, vec3f(1e-20));
    return gathered * clamp(ratio, vec3f(1.0 / MOST_DETAIL), vec3f(MOST_DETAIL));
}

fn variance_of_sum(sum: f32, squares: f32, count: u32) -> f32 {
    return max(squares - sum * sum / f32(count), 0.0);
}

fn sameness(a: f32, b: f32, variance: f32) -> f32 {
    let off = max((a - b) * (a - b) - variance, 0.0);
    let same = SAME * (a + b);
    return exp(-off / max(DOUBT * variance + same * same, 1e-30));
}

fn nearness(side: vec3f, inverse_m: f32, haze: f32) -> mat2x3f {
    let along = mix(ALONG, 1.0, haze);
    return inverse_m * mat2x3f(vec3f(along) + (1.0 - along) * side * side, (1.0 - along) * side.yzx * side.zxy);
}

// Squared, over how near surfaces lie: how far a path of `offset` leads towards them.
fn approach(offset: vec3f, squares: vec3f, products: vec3f) -> f32 {
    let turned = squares * offset + products.yzx * offset.zxy + products.zxy * offset.yzx;
    return dot(turned, turned);
}

fn closeness(offset: vec3f, squares: vec3f, products: vec3f) -> f32 {
    return exp(-approach(offset, squares, products) / (REACH * REACH));
}

fn far_closeness(offset: vec3f, inverse_m: f32, side: vec3f, its_side: vec3f) -> f32 {
    let beyond = max(min(-dot(side, offset), dot(its_side, offset)), 0.0) / THROUGH;
    let pace = inverse_m / REACH;
    return exp(-beyond * beyond - pace * pace * dot(offset, offset));
}

fn far_likeness(like: f32, normal: vec3f, its_normal: vec3f) -> f32 {
    return max(like, pow(saturate(dot(normal, its_normal)), FAR_POWER));
}

fn calibration(traced: f32, known: f32, ends: f32) -> f32 {
    let own = known - ends;
    let doubt = CALIBRATION_DOUBT * ends;
    let factor = 1.0 + own * (traced - own) / max(own * own + doubt * doubt, 1e-30);
    return clamp(factor, 1.0 / MOST_CALIBRATION, MOST_CALIBRATION);
}
