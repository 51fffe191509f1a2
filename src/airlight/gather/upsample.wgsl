// Irradiance of pixels from the gather points around them that lie on about the same plane (joint bilateral
// upsampling, Kopf2007), turned to each pixel's own normal and near occluders. Where the blocks of four points next to
// a pixel show other surfaces, as at the foot of a wall, the sixteen around it are asked; and where none of their points
// is like it, those that get about the same light, before the lattices.
//! use pixel_point
//! use gather_orphans
//! use orphans
//! use point_sums
//! use flat_normal
//! use mirrored_light
//! use surface_coordinates
//! use tone
//! use near_field_lookup

const FEW = 0.1;            // weight of points below which those farther off are asked, too, and kin count
const LEAST = 0.01;         // weight of points below which kin count in full
const KIN = 0.01;           // weight of points that are not alike, but get about the same light
const LATTICES = 1e-4;      // weight of what lattices say

struct Found {
    @location(0) irradiance: vec4f,     // W m^-2
    @location(1) sky: vec4f,
}

// Of the points around a pixel: the sums of all light, as far as each is like it, and how far all are.
struct Around {
    surfaces: vec3f,        // W m^-2 sr^-1
    surfaces_flux: vec3f,
    sky: vec3f,
    sky_flux: vec3f,
    open: f32,              // share of the hemisphere that near occluders leave
    total: f32,
    alike: f32,             // of the total, what points that are like the pixel have
}

// Weights fall off linearly over `reach` points, 1 or 2; kin count `kin_weight`.
fn around(position: vec2f, p: vec3f, n: vec3f, reach: i32, kin_weight: f32) -> Around {
    // The points around the pixel: 2 reach of them along each axis, the nearer the more.
    let texel_m = params.texel * length(p - params.eye);
    let last = vec2i(params.reduced) - 1;
    let middle = position / f32(params.scale) - 0.5;
    let base = vec2i(floor(middle)) + 1 - reach;
    var out: Around;
    var k = 0;
    loop {
        let corner = base + vec2i(k % (2 * reach), k / (2 * reach));
        let near = max(1.0 - abs(middle - vec2f(corner)) / f32(reach), vec2f(0.0)) + 1e-3;
        // The block's point, and those of its orphans.
        var texel = vec2u(clamp(corner, vec2i(0), last));
        let orphans = orphans_of(texel);
        var next = orphans.first;
        loop {
            let place = textureLoad(places, texel, 0);
            let its = textureLoad(planes, texel, 0).xyz;
            let its_sums = sums_at(sums, texel);
            let each = 1.0 / max(its_sums.met_rays, FEWEST * f32(params.rays));
            // By how alike their surfaces are, and by how alike their light is.
            let kin = kinship(n, its, p - place.xyz, each * its_sums.squares, each * its_sums.products, texel_m);
            let share = select(0.0, near.x * near.y, place.w > 0.0);
            let like = share * likeness(p, n, place.xyz, its, texel_m);
            let weight = like + kin_weight * share * kin;
            out.alike += like;
            out.surfaces += weight * its_sums.near;
            out.surfaces_flux += weight * its_sums.near_flux;
            out.sky += weight * its_sums.sky;
            out.sky_flux += weight * its_sums.sky_flux;
            out.open += weight * its_sums.open;
            out.total += weight;
            if (next >= orphans.end) { break; }
            texel = orphan_texel(next);
            next++;
        }
        k++;
        if (k >= 4 * reach * reach) { break; }
    }
    return out;
}

struct Unlike {
    irradiance: vec3f,      // W m^-2
    sky: vec3f,
}

// What lattices have, where no point is like the pixel.
fn of_lattices(p: vec3f, normal: vec3f) -> Unlike {
    // All lattices have the same axes.
    let n = lattice_from_world(lattice_of(0u), normal);
    var out = Unlike(vec3f(0.0), vec3f(0.0));
    var at = lattice_step(0u, 1.0, p);
    loop {
        let uvw = lattice_coordinates(lattice_of(at.k), p, n);
        out.irradiance += at.weight * lattice_irradiance(lattice_of(at.k), uvw, n);
        out.sky += at.weight * sky_at(uvw, n);
        if (at.is_last) {
            break;
        }
        at = lattice_step(at.k + 1u, at.left, p);
    }
    return out;
}

// Irradiance of a pixel of normal n, W m^-2, `open` to what is near, from `light` and `flux` of points that are
// on average `its_open`.
fn turned(light: vec3f, flux: vec3f, n: vec3f, open: vec3f, its_open: vec3f) -> vec3f {
    let ratio = turn_ratio(flux / max(luminance(light), 1e-20), n);
    return detailed(light, its_open * light, open * ratio * light);
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Found {
    let pixel = vec2u(position.xy);
    let d = textureLoad(depth, pixel, 0);
    if (d <= 0.0) {
        return Found(vec4f(0.0), vec4f(0.0));
    }
    let p = pixel_point(position.xy, d);
    let n = normalize(textureLoad(normal, pixel, 0).xyz);
    let flat_n = flat_normal(vec2i(pixel), p, n);
    var found = around(position.xy, p, flat_n, 1, 0.0);
    if (found.alike < FEW) {
        // The fewer points are alike, the more those count that are not.
        found = around(position.xy, p, flat_n, 2, KIN * (1.0 - smoothstep(LEAST, FEW, found.alike)));
    }
    // Near occluders hide the sky, and send light that they reflect.
    let open = near_field_at(position.xy, 1.0 / (params.world_from_clip[2].w * d)).open;
    let tint = textureLoad(albedo, pixel, 0).rgb;
    let seen = interreflected(open, tint);
    // Of cosine-distributed rays, pi times the mean radiance.
    let is_any = found.total > 1e-3 * LATTICES;
    let scale = select(0.0, 3.14159265 / (f32(params.rays) * found.total), is_any);
    let its_open = found.open * select(0.0, 1.0 / found.total, is_any);
    let surfaces = turned(scale * found.surfaces, scale * found.surfaces_flux, n, seen, interreflected(its_open, tint));
    let of_sky = turned(scale * found.sky, scale * found.sky_flux, n, vec3f(open), vec3f(its_open));
    let share = found.total / (found.total + LATTICES);
    let unlike = of_lattices(p, n);
    return Found(vec4f(mix(seen * unlike.irradiance, surfaces, share), 1.0),
        vec4f(mix(open * unlike.sky, of_sky, share), 1.0));
}
