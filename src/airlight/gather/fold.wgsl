// What a segment of paths found: its light, times what the segments before it reflect.
//! use gather
//! use light_guide
//! use sky_cells
//! use octahedron
//! use tone
//! needs fn air_of(row: u32) -> Air

// What becomes of the lattices' light: it is no part of the path; or it is, as it is; or it is told beside what the
// last segment finds; or that segment's end leaves it to `calibrated.wgsl`.
const ADDED = 1u;
const TOLD = 2u;
const LEFT = 3u;

// The light that media scatter into a segment, and their transmittance.
struct Air {
    light: vec3f,           // W m^-2 sr^-1
    inverse_m: f32,         // of how far away they do
    passed: vec3f,
}

struct Path {
    radiance: vec3f,        // W m^-2 sr^-1
    inverse_m: f32,         // of the first segment's length; below 0 it left the scene
    passed: vec3f,          // of the light that goes on; the sky's radiance where it left
    is_open: f32,
}

fn first_found(texel: vec2u, hit: vec4f, air: Air) -> Path {
    let at = vec2u(texel.x, texel.y % sky.reduced.y);
    let start = textureLoad(starts, at, 0);
    var path = Path(vec3f(0.0), 0.0, vec3f(1.0), 1.0);
    if (hit.w > 0.0) {
        let inverse_m = 1.0 / max(distance(hit.xyz, start.xyz), 1e-6);
        path.inverse_m = mix(air.inverse_m, inverse_m, dot(air.passed, vec3f(1.0 / 3.0)));
    } else if (start.w > 0.0) {
        // Where a ray left the scene, its direction.
        let seen = sky_along(hit.xyz);
        let n = textureLoad(normals, at, 0).xyz;
        let share = sky_share(dot(hit.xyz, n), seen.density, sky.rays, sky.sky_rays);
        path = Path(air.light, -1.0, share * air.passed * seen.radiance, 0.0);
    }
    return path;
}

// What the light of lights counts that a ray from a point has found, where other rays are guided to it.
fn first_share(texel: vec2u, hit: vec4f) -> f32 {
    let at = vec2u(texel.x, texel.y % sky.reduced.y);
    let start = textureLoad(starts, at, 0);
    let n = textureLoad(normals, at, 0).xyz;
    let origin = start.xyz;
    let direction = normalize(hit.xyz - origin);
    let density = guide_density(origin, n, direction);
    return sky_share(dot(direction, n), density, sky.rays, params.guided);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= sky.reduced.x || id.y >= sky.reduced.y * params.rays) {
        return;
    }
    let hit = textureLoad(hit_positions, id.xy, 0);
    let row = 2u * (id.y * sky.reduced.x + id.x);
    let air = air_of(row);
    var path: Path;
    // The first segment begins the path, later ones take it up.
    if (params.segment == 0u) {
        path = first_found(id.xy, hit, air);
        let side = octahedron_encode(textureLoad(hit_normals, id.xy, 0).xyz);
        let haze = 1.0 - dot(air.passed, vec3f(1.0 / 3.0));
        met[id.y * sky.reduced.x + id.x] = pack4x8snorm(vec4f(side, haze, 0.0));
    } else {
        let radiance = paths[row];
        let passed = paths[row + 1u];
        path = Path(radiance.rgb, radiance.a, passed.rgb, passed.a);
    }
    var known = vec3f(0.0);     // by lattices
    var traced = 0.0;           // luminance
    if (path.is_open > 0.0) {
        // Light of media along the segment and of the surface at its end, times what the path passes on.
        var found = path.passed * air.light;
        path.passed *= air.passed;
        if (hit.w > 0.0) {
            let towards_lights = textureLoad(hit_albedos, id.xy, 0).rgb;
            let albedo = towards_lights + textureLoad(hit_normals, id.xy, 0).w;
            let all_around = albedo / max(towards_lights, vec3f(1e-4));
            // Most rays meet what no light shines on: only the others ask how likely a guide is to send them.
            let lit = textureLoad(direct_light, id.xy, 0).rgb;
            var share = 1.0;
            // Other rays are guided to the same light; each of them counts a share.
            if (params.segment == 0u && params.guided > 0u && any(lit > vec3f(0.0))) {
                share = first_share(id.xy, hit);
            }
            found += share * path.passed * lit;
            var forward = vec3f(0.0);
            if (params.has_forward != 0u) {
                forward = path.passed * all_around * textureLoad(forward_light, id.xy, 0).rgb;
                found += forward;
            }
            if (params.lattices != 0u) {
                known = path.passed * all_around * textureLoad(lattice_light, id.xy, 0).rgb - forward;
            }
            if (params.lattices == ADDED) {
                found += known;
            }
            // Of the paths some end here, and the others count for them.
            path.passed *= params.counts * albedo;
        }
        traced = luminance(found);
        path.radiance += found;
        if (hit.w <= 0.0) {
            // A sky with a sun in it lights surfaces through the lattice: it would be found by luck.
            if (params.segment > 0u && sky.is_mild != 0u) {
                path.radiance += path.passed * sky_along(hit.xyz).radiance;
            }
            path.is_open = 0.0;
        }
        if (params.lattices == LEFT) {
            path.passed = known;
        }
    }
    paths[row] = vec4f(path.radiance, path.inverse_m);
    paths[row + 1u] = vec4f(path.passed, path.is_open);
    // What both say of the light where the second last segment ends.
    let index = id.y * sky.reduced.x + id.x;
    if (params.lattices == TOLD) {
        shares[index] = vec4f(0.0, params.counts * luminance(known), 0.0, 0.0);
    } else if (params.lattices == LEFT) {
        shares[index] = vec4f(traced, shares[index].y, luminance(known), 0.0);
    }
}
