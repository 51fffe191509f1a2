// Irradiance of pixels from the gather points around them that lie on about the same plane (joint bilateral
// upsampling, Kopf et al. 2007), times how lattices and near occluders tell a pixel from its points.
//! use pixel_point
//! use gather
//! use flat_normal
//! use mirrored_light

const LEAST = 1e-2;         // weight of what lattices say, where hardly any point is alike

struct Found {
    @location(0) irradiance: vec4f,     // W m^-2
    @location(1) sky: vec4f,
}

// What the points around a pixel say: their sums, and how far they are like it.
struct Around {
    sum: array<vec4f, SUMS>,
    total: f32,
}

fn around(position: vec2f, p: vec3f, n: vec3f) -> Around {
    let texel_m = params.texel * length(p - params.eye);
    let last = vec2i(params.reduced) - 1;
    let middle = position / f32(params.scale) - 0.5;
    let base = floor(middle);
    let t = middle - base;
    var out: Around;
    var k = 0;
    loop {
        let corner = vec2f(f32(k & 1), f32(k >> 1u));
        let at = clamp(vec2i(base + corner), vec2i(0), last);
        let place = textureLoad(places, at, 0);
        let its = textureLoad(planes, at, 0).xyz;
        let near = mix(1.0 - t, t, corner) + 1e-3;
        let like = near.x * near.y * likeness(p, n, place.xyz, its, texel_m);
        let weight = select(0.0, like, place.w > 0.0);
        let index = SUMS * u32(at.y * i32(params.reduced.x) + at.x);
        for (var i = 0u; i < SUMS; i++) {
            out.sum[i] += weight * sums[index + i];
        }
        out.total += weight;
        k++;
        if (k > 3) { break; }
    }
    return out;
}

// What lattices and sky have at one place for two normals, and for the first as surfaces are lit without rays.
struct Compared {
    own: vec3f,         // W m^-2
    its: vec3f,
    own_sky: vec3f,
    its_sky: vec3f,
    surface: vec3f,
}

fn compared(p: vec3f, plane: vec3f, own: vec3f, its: vec3f) -> Compared {
    // All lattices have the same axes.
    let axes = lattice_of(0u);
    let flat_n = lattice_from_world(axes, plane);
    let own_n = lattice_from_world(axes, own);
    let its_n = lattice_from_world(axes, its);
    var out = Compared(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0));
    // The finest lattice that has the point; towards its border the next larger one.
    let last = last_lattice();
    var left = 1.0;
    var k = 0u;
    loop {
        k = lattice_from(k, p);
        let weight = left * lattice_weight(lattice_of(k), p);
        let uvw = lattice_coordinates(lattice_of(k), p, flat_n);
        out.own += weight * lattice_irradiance_at(lattice_of(k), uvw, own_n);
        out.its += weight * lattice_irradiance_at(lattice_of(k), uvw, its_n);
        out.own_sky += weight * sky_at(uvw, own_n);
        out.its_sky += weight * sky_at(uvw, its_n);
        out.surface += weight * lattice_irradiance(lattice_of(k), uvw, own_n);
        left -= weight;
        k++;
        if (k > last || left <= 0.0) {
            break;
        }
    }
    return out;
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Found {
    let pixel = vec2u(position.xy);
    let d = textureLoad(depth, pixel, 0);
    if (d <= 0.0) {
        return Found(vec4f(0.0), vec4f(0.0));
    }
    let p = pixel_point(position.xy, d);
    let n = normalize(textureLoad(normal, pixel, 0).xyz);
    let plane = flat_normal(vec2i(pixel), p, n);
    let found = around(position.xy, p, plane);
    let is_any = found.total > 1e-4 * LEAST;
    // Of cosine-distributed rays, pi times the mean radiance.
    let scale = select(0.0, 3.14159265 / found.sum[1].w, is_any);
    let mean = found.sum[2] * select(0.0, 1.0 / found.total, is_any);
    let its_n = select(n, normalize(mean.xyz), dot(mean.xyz, mean.xyz) > 1e-3);
    let lattice = compared(p, plane, n, its_n);
    // Near occluders hide the sky, and send light that they reflect.
    let open = near_field_at(position.xy, 1.0 / (params.world_from_clip[2].w * d)).open;
    let tint = textureLoad(albedo, pixel, 0).rgb;
    let seen = interreflected(open, tint);
    let its_seen = interreflected(mean.w, tint);
    let surfaces = detailed(scale * found.sum[0].rgb, its_seen * lattice.its, seen * lattice.own);
    let of_sky = detailed(scale * found.sum[1].rgb, mean.w * lattice.its_sky, open * lattice.own_sky);
    let share = found.total / (found.total + LEAST);
    return Found(vec4f(mix(seen * lattice.surface, surfaces, share), 1.0),
        vec4f(mix(open * lattice.own_sky, of_sky, share), 1.0));
}
