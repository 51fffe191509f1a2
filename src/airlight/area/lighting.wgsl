// Light of emitters with extent: polygons and spheres in closed form (Heitz2016), times the share of their samples that
// shadow maps show; other shapes as the sum of their samples.
//! use area_light
//! use area_shadow
//! use segment_light
//! use widened_lobe
//! use specular_cosine
//! use glow_share
//! use sampling
//! needs fn surface_depth(pixel: vec2u) -> f32
//! needs fn surface_point(position: vec2f, d: f32) -> vec3f
//! needs fn media_passed(row: u32, count: u32, p: vec3f) -> vec3f

const POLYGON = 0u;
const SPHERE = 1u;
const SAMPLES = 2u;
const MOST_CORNERS = 12u;
const OWN_PLANE = 1e-3;     // of a polygon's radius

// CPU adapters run both sides of every branch: what no emitter and no surface has is left out.
override HAS_POLYGONS: bool = true;
override HAS_SPHERES: bool = true;
override HAS_SAMPLES_ALONE: bool = true;
override HAS_CUBES: bool = true;
override HAS_SEGMENTS: bool = true;     // of samples that are all there is of an emitter
override HAS_SPOTS: bool = true;
override HAS_GLOSS: bool = true;
override ARE_FLAT: bool = false;    // all emitters, and none of their samples a cube

struct Seen {
    p: vec3f,
    n: vec3f,
    v: vec3f,
    r: Reflector,
    mirrored: f32,  // share of highlights of media that mirrored rays show
}

// Irradiance of radiance 1, and the share of the lobe: x, y.
fn analytic(i: u32, e: EmitterData, s: Seen, frame: mat3x3f, lobe: mat3x3f, is_glossy: bool) -> vec2f {
    // Rows of `frame` are the axes about the normal: corners times it lie in them.
    let centre = (e.centre - s.p) * frame;
    // A sphere without gloss has a closed form; the lobe sees it as the rim of a disk.
    var round = vec4f(0.0);
    var axes = mat3x3f();
    var count = e.corner_count;
    if (HAS_SPHERES && e.kind == SPHERE) {
        if (!HAS_GLOSS || !is_glossy) {
            return vec2f(sphere_irradiance(centre, e.radius), 0.0);
        }
        round = sphere_disk(centre, e.radius);
        axes = orthonormal_frame(round.xyz);
        count = RIM_CORNERS;
    }
    // Corner by corner, as seen by the cosine and by the lobe; the last one comes first, to close the outline.
    var at = count - 1u;
    var matt = Outline();
    var gloss = Outline();
    var k = 0u;
    loop {
        var corner: vec3f;
        if (HAS_SPHERES && (!HAS_POLYGONS || e.kind == SPHERE)) {
            corner = rim_corner(centre, axes, round.w, at);
        } else {
            corner = (corners[i * MOST_CORNERS + at].position - s.p) * frame;
        }
        if (k == 0u) {
            matt = outline_from(corner);
            if (HAS_GLOSS && is_glossy) { gloss = outline_from(lobe * corner); }
        } else {
            matt = outline_to(matt, corner);
            if (HAS_GLOSS && is_glossy) { gloss = outline_to(gloss, lobe * corner); }
        }
        at = k;
        k++;
        if (k > count) { break; }
    }
    // A sphere's own irradiance is exact, which its rim's is not.
    var irradiance = outline_irradiance(matt);
    if (HAS_SPHERES && e.kind == SPHERE) {
        irradiance = sphere_irradiance(centre, e.radius);
    }
    var share = 0.0;
    if (HAS_GLOSS && is_glossy) {
        share = outline_irradiance(gloss) / PI;
    }
    return vec2f(irradiance, share);
}

// Light of the samples alone, where they are all there is of an emitter; and what of it is seen.
struct Sum {
    matt: vec2f,        // weights, and those that are seen
    gloss: vec2f,
    light: vec3f,       // W m^-2 sr^-1 towards the eye
}

fn viewed(own: vec3f, axes: mat3x3f, s: Seen) -> Viewed {
    let n = s.n * axes;
    return Viewed(own, n, s.v * axes, abs(n.x) + abs(n.y) + abs(n.z));
}

fn summed(e: EmitterData, s: Seen, frame: mat3x3f, lobe: SpecularCosine, is_glossy: bool) -> Sum {
    var sum = Sum(vec2f(0.0), vec2f(0.0), vec3f(0.0));
    // Samples of flat emitters share all but place and brightness: CPU adapters read lane by lane.
    let first = samples[e.first_sample];
    let axes = mat3x3f(first.x, first.y, first.z);
    let from_first = (s.p - first.position) * axes;
    var at = viewed(from_first, axes, s);
    // Where half of many samples see all, or nothing, so do the others, but for thin things in between.
    let enough = select(0u, e.sample_count / 2u, e.sample_count >= params.many && e.kind != SAMPLES);
    var k = 0u;
    loop {
        let sample = samples[e.first_sample + k];
        if (ARE_FLAT) {
            at.own = from_first - sample.offset;
        } else {
            let turned = mat3x3f(sample.x, sample.y, sample.z);
            at = viewed((s.p - sample.position) * turned, turned, s);
        }
        let true_squared = max(dot(at.own, at.own), 1e-12);
        var squared = max(true_squared, e.nearest);
        // Cosines at both ends, times the distance.
        let rise = max(-dot(at.n, at.own), 0.0);
        let fall = 0.57735027 * max(at.own.x + at.own.y + at.own.z, 0.0);
        var sent = fall * rise / (true_squared * squared);
        var first_view = first.first_view + 3u * k;
        var is_cube = false;
        var depth = e.depth;
        if (!ARE_FLAT) {
            squared = max(true_squared, sample.nearest);
            first_view = sample.first_view;
            is_cube = HAS_CUBES && sample.is_cube != 0u;
            depth = vec2f(sample.depth_scale, sample.depth_offset);
            let back = select(fall, max(dot(at.own, sample.normal), 0.0), is_cube);
            let inverse = inverseSqrt(true_squared);
            sent = (sample.front * back * inverse + sample.even) * rise * inverse / squared;
        }
        // What an emitter without closed form sends to the eye by this sample.
        let weight = sent * sample.brightness;
        var reflected = vec3f(0.0);
        if (HAS_SAMPLES_ALONE && e.kind == SAMPLES) {
            let is_long = HAS_SEGMENTS && sample.width > 0.0;
            if (is_long) {
                let turned = mat3x3f(sample.x, sample.y, sample.z);
                let into = lobe.inverse * transpose(frame) * turned;
                reflected = segment_light(sample, sample.normal * turned, at, s.r, into, lobe.albedos, is_glossy);
            } else if (HAS_GLOSS) {
                let l = -at.own * inverseSqrt(true_squared);
                let left = select(0.0, s.mirrored, e.is_medium != 0u);
                reflected = sent * mix(reflection(s.r, at.n, l, at.v), matt_reflection(s.r, l, at.v), left);
            } else {
                reflected = sent / PI * s.r.diffuse;
            }
        }
        if (max(weight, max(reflected.x, max(reflected.y, reflected.z))) > 0.0) {
            // As far as its shadow map shows the point, and within a spot's cone.
            var open = sample_visibility(first_view, is_cube, depth, at);
            if (HAS_SPOTS && e.cos_outer > -1.0) {
                let away = normalize(s.p - sample.position);
                open *= smoothstep(e.cos_outer, max(e.cos_inner, e.cos_outer + 1e-4),
                    dot(away, e.axis));
            }
            sum.matt += weight * vec2f(1.0, open);
            if (HAS_GLOSS && is_glossy) {
                let wide = sqrt(select(sample.nearest, e.nearest, ARE_FLAT) / squared);
                sum.gloss += weight * widened_lobe(at, -at.own * inverseSqrt(true_squared), s.r.alpha, wide)
                    * vec2f(1.0, open);
            }
            sum.light += open * sample.color * reflected;
        }
        k++;
        if (k >= e.sample_count) { break; }
        if (k == enough && (sum.matt.y == sum.matt.x || sum.matt.y == 0.0)) { break; }
    }
    return sum;
}

fn emitter_light(i: u32, s: Seen, frame: mat3x3f, lobe: SpecularCosine, is_glossy: bool) -> vec3f {
    let e = emitters[i];
    // A polygon does not light its back, nor, within rounding, its own plane.
    if (e.kind == POLYGON && dot(s.p - e.centre, e.normal) <= OWN_PLANE * e.radius) {
        return vec3f(0.0);
    }
    let passed = media_passed(e.row, e.row_count, s.p);
    if (HAS_SAMPLES_ALONE && e.kind == SAMPLES) {
        return passed * summed(e, s, frame, lobe, is_glossy).light;
    }
    // All of it in closed form, and the share of it that is seen.
    let found = analytic(i, e, s, frame, lobe.inverse, is_glossy);
    if (max(found.x, found.y) <= 0.0) {
        return vec3f(0.0);
    }
    let seen = summed(e, s, frame, lobe, is_glossy);
    let open = select(1.0, seen.matt.y / max(seen.matt.x, 1e-30), seen.matt.x > 0.0);
    if (!HAS_GLOSS) {
        return e.radiance * passed * s.r.diffuse * (found.x * open / PI);
    }
    // Where no sample lies in the lobe, the share of all light is the best there is.
    let few = 1e-3 * seen.matt;
    let lobe_open = select(open, (seen.gloss.y + few.y) / (seen.gloss.x + few.x), seen.matt.x > 0.0);
    // Fresnel towards the middle divides the light between coat and paint.
    let h = normalize(normalize(e.centre - s.p) + s.v);
    let f = fresnel(s.r.f0, saturate(dot(s.v, h)));
    let f90 = saturate(max(s.r.f0.x, max(s.r.f0.y, s.r.f0.z)) * 50.0);
    let matt = (vec3f(1.0) - f) * s.r.diffuse / PI * found.x * open;
    let gloss = (s.r.f0 * lobe.albedos.x + vec3f(f90 * lobe.albedos.y)) * found.y * lobe_open;
    return e.radiance * passed * (matt + gloss);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let d = surface_depth(pixel);
    let glow = textureLoad(emission, pixel, 0);
    if (d <= 0.0) {
        return glow;
    }
    // The surface, as the G-buffer has it.
    let base = textureLoad(albedo, pixel, 0);
    let bent = textureLoad(normal, pixel, 0);
    var s: Seen;
    s.p = surface_point(position.xy, d);
    s.v = normalize(params.eye - s.p);
    s.n = normalize(bent.xyz);
    s.r = reflector(base.rgb, base.a, bent.w, glow.a);
    let n_v = dot(s.n, s.v);
    // What mirrored rays show of media that glow is no highlight.
    if (HAS_GLOSS && params.has_mirrors != 0u) {
        s.mirrored = medium_glow_share(s.r.alpha) * glossy_share(specular_albedo(s.r, max(n_v, 1e-4)), sqrt(s.r.alpha));
    }
    // Axes of normal and view.
    let flat = s.v - n_v * s.n;
    let x = select(orthonormal_frame(s.n)[0], normalize(flat), dot(flat, flat) > 1e-10);
    let frame = mat3x3f(x, cross(s.n, x), s.n);
    let is_glossy = HAS_GLOSS && any(s.r.f0 > vec3f(0.0));
    var lobe: SpecularCosine;
    if (HAS_GLOSS && is_glossy) {
        lobe = specular_cosine(n_v, s.r.alpha);
    }
    var sum = glow.rgb;
    var i = 0u;
    loop {
        sum += emitter_light(i, s, frame, lobe, is_glossy);
        i++;
        if (i >= params.emitter_count) { break; }
    }
    return vec4f(sum, glow.a);
}
