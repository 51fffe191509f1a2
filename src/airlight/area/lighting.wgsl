//! use pixel_point
//! use image_texel
//! use area_light
//! use specular_cosine
//! needs fn media_passed(row: u32, p: vec3f) -> vec3f

const POLYGON = 0u;
const SPHERE = 1u;
const SAMPLES = 2u;
const MOST_CORNERS = 12u;

struct Seen {
    p: vec3f,
    n: vec3f,
    v: vec3f,
    r: Reflector,
}

// Irradiance of radiance 1, and the share of the lobe: x, y.
fn analytic(i: u32, e: EmitterData, s: Seen, frame: mat3x3f, lobe: mat3x3f, is_glossy: bool) -> vec2f {
    // Rows of `frame` are the axes about the normal: corners times it lie in them.
    let centre = (e.centre - s.p) * frame;
    var round = vec4f(0.0);
    var axes = mat3x3f();
    var count = e.corner_count;
    if (e.kind == SPHERE) {
        round = sphere_disk(centre, e.radius);
        axes = orthonormal_frame(round.xyz);
        count = RIM_CORNERS;
    }
    var at = count - 1u;
    var matt = Outline();
    var gloss = Outline();
    var k = 0u;
    loop {
        var corner: vec3f;
        if (e.kind == SPHERE) {
            corner = rim_corner(centre, axes, round.w, at);
        } else {
            corner = (corners[i * MOST_CORNERS + at].position - s.p) * frame;
        }
        if (k == 0u) {
            matt = outline_from(corner);
            if (is_glossy) { gloss = outline_from(lobe * corner); }
        } else {
            matt = outline_to(matt, corner);
            if (is_glossy) { gloss = outline_to(gloss, lobe * corner); }
        }
        at = k;
        k++;
        if (k > count) { break; }
    }
    var irradiance = outline_irradiance(matt);
    if (e.kind == SPHERE) {
        irradiance = sphere_irradiance(centre, e.radius);
    }
    return vec2f(irradiance, select(0.0, outline_irradiance(gloss) / PI, is_glossy));
}

// How much of a point a sample sees. Twin of the views: area/table.py.
fn sample_visibility(sample: SampleData, s: Seen) -> f32 {
    let away = s.p - sample.position;
    let own = vec3f(dot(away, sample.x), dot(away, sample.y), dot(away, sample.z));
    let is_cube = sample.is_cube != 0u;
    let span = select(3.0, 2.0, is_cube);
    let size = select(own, abs(own), is_cube);
    let farthest = max(size.x, max(size.y, size.z));
    // The point is moved along its normal so far that its own plane lies behind it in all four texels
    // that are compared: by what the plane rises towards the light over a texel along both sides.
    let texel_m = span * params.texel * max(farthest, 0.0);
    let n = vec3f(dot(s.n, sample.x), dot(s.n, sample.y), dot(s.n, sample.z));
    let across = abs(n.x) + abs(n.y) + abs(n.z) - abs(dot(n, select(vec3f(0.0), vec3f(1.0), size == vec3f(farthest))));
    let moved = own + n * (texel_m * (1.05 * across + 0.1));
    let reach = select(moved, abs(moved), is_cube);
    // The axis it lies nearest to; the other two follow in turn.
    let is_y = reach.y > reach.x && reach.y >= reach.z;
    let is_z = reach.z > reach.x && !is_y;
    let turned = select(select(moved, moved.yzx, is_y), moved.zxy, is_z);
    let ahead = select(1.0, sign(turned.x), is_cube);
    let forward = turned.x * ahead;
    let layer = sample.first_view + select(select(0u, 1u, is_y), 2u, is_z)
        + select(0u, 3u, ahead < 0.0);
    let plane = vec2f(turned.z * ahead, turned.y) / max(forward, 1e-9);
    let ndc = select((plane + 0.5) / 1.5, plane, is_cube);
    let uv = clamp(ndc * vec2f(0.5, -0.5) + 0.5, vec2f(0.0), vec2f(1.0));
    let z = sample.far / (sample.far - sample.near) * (1.0 - sample.near / max(forward, 1e-9));
    if (forward <= sample.near || z >= 1.0) {
        return 1.0;
    }
    return textureSampleCompareLevel(area_shadows, shadow_compare, uv, layer, z);
}

// Light of the samples alone, where they are all there is of an emitter; and what of it is seen.
struct Sum {
    matt: vec2f,        // weights, and those that are seen
    gloss: vec2f,
    light: vec3f,       // W m^-2 sr^-1 towards the eye
}

fn summed(e: EmitterData, s: Seen, is_glossy: bool) -> Sum {
    var sum = Sum(vec2f(0.0), vec2f(0.0), vec3f(0.0));
    let n_v = max(dot(s.n, s.v), 1e-4);
    var k = 0u;
    loop {
        let sample = samples[e.first_sample + k];
        let delta = sample.position - s.p;
        let true_squared = dot(delta, delta);
        let to_light = delta * inverseSqrt(max(true_squared, 1e-12));
        let squared = max(true_squared, sample.nearest);
        let cosine = max(dot(s.n, to_light), 0.0);
        let back = max(-dot(to_light, sample.normal), 0.0);
        let sent = (sample.front * back + sample.even) / squared
            * dot(sample.color, vec3f(0.3333333));
        let weight = sent * cosine;
        if (weight > 0.0) {
            var open = sample_visibility(sample, s);
            if (e.cos_outer > -1.0) {
                open *= smoothstep(e.cos_outer, max(e.cos_inner, e.cos_outer + 1e-4),
                    -dot(to_light, e.axis));
            }
            sum.matt += weight * vec2f(1.0, open);
            if (is_glossy) {
                // The lobe as wide as the sample makes it.
                let alpha = saturate(s.r.alpha + 0.5 * sqrt(sample.nearest / squared));
                let h = normalize(to_light + s.v);
                let gloss = weight * ggx_distribution(saturate(dot(s.n, h)), alpha)
                    * smith_visibility(cosine, n_v, alpha);
                sum.gloss += gloss * vec2f(1.0, open);
            }
            if (e.kind == SAMPLES) {
                let power = (sample.front * back + sample.even) / squared * cosine * open;
                sum.light += sample.color * power * reflection(s.r, s.n, to_light, s.v);
            }
        }
        k++;
        if (k >= e.sample_count) { break; }
    }
    return sum;
}

fn emitter_light(i: u32, s: Seen, frame: mat3x3f, lobe: SpecularCosine, is_glossy: bool) -> vec3f {
    let e = emitters[i];
    if (e.kind == POLYGON && dot(s.p - e.centre, e.normal) <= 0.0) {
        return vec3f(0.0);
    }
    let passed = media_passed(e.row, s.p);
    if (e.kind == SAMPLES) {
        return passed * summed(e, s, false).light;
    }
    let found = analytic(i, e, s, frame, lobe.inverse, is_glossy);
    if (max(found.x, found.y) <= 0.0) {
        return vec3f(0.0);
    }
    let seen = summed(e, s, is_glossy);
    let open = select(1.0, seen.matt.y / seen.matt.x, seen.matt.x > 0.0);
    // Where no sample lies in the lobe, the share of all light is the best there is.
    let few = 1e-3 * seen.matt;
    let lobe_open = select(open, (seen.gloss.y + few.y) / (seen.gloss.x + few.x), seen.matt.x > 0.0);
    let h = normalize(normalize(e.centre - s.p) + s.v);
    let f = fresnel(s.r.f0, saturate(dot(s.v, h)));
    let f90 = saturate(max(s.r.f0.x, max(s.r.f0.y, s.r.f0.z)) * 50.0);
    let matt = (vec3f(1.0) - f) * s.r.diffuse / PI * found.x * open;
    let gloss = (s.r.f0 * lobe.albedos.x + vec3f(f90 * lobe.albedos.y)) * found.y * lobe_open;
    return e.radiance * passed * (matt + gloss);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let d = depth_texel(depth, pixel);
    let glow = image_texel(emission, pixel);
    if (d <= 0.0) {
        return glow;
    }
    let base = image_texel(albedo, pixel);
    let bent = image_texel(normal, pixel);
    var s: Seen;
    s.p = pixel_point(position.xy, d);
    s.v = normalize(params.eye - s.p);
    s.n = normalize(bent.xyz);
    s.r = reflector(base.rgb, base.a, bent.w, glow.a);
    let n_v = dot(s.n, s.v);
    // Axes of normal and view.
    let flat = s.v - n_v * s.n;
    let x = select(orthonormal_frame(s.n)[0], normalize(flat), dot(flat, flat) > 1e-10);
    let frame = mat3x3f(x, cross(s.n, x), s.n);
    let is_glossy = any(s.r.f0 > vec3f(0.0));
    var lobe: SpecularCosine;
    if (is_glossy) {
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
