//! use rays
//! use ray_surface

// One ray a pixel. KIND: 0 from the eye, 1 from what that met, by the cosine, 2 the same, for any hit.

// Three rows a pixel: where the first ray met something, and 1; the normal there, towards it; what the ray found.
@compute @workgroup_size(WX, WY, WZ)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let inside = all(id.xy < params.size);
    let pixel = min(id.xy, params.size - 1u);
    let row = 3u * (pixel.y * params.size.x + pixel.x);
    // Camera rays, and where the next kinds start.
    if (KIND == 0u) {
        let at = (vec2f(pixel) + 0.5) / vec2f(params.size) * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0);
        let far = params.world_from_clip * vec4f(at, 1e-3, 1.0);
        let towards = normalize(far.xyz / far.w - params.eye);
        let hit = nearest_hit(params.eye, towards, 0.0, 3e38);
        let met = hit_point(hit);
        let side = select(-1.0, 1.0, dot(met.geometric_normal, towards) < 0.0);
        if (inside) {
            starts[row] = vec4f(met.position, f32(hit.triangle != NO_HIT));
            starts[row + 1u] = vec4f(met.geometric_normal * side, 0.0);
        }
        return;
    }
    let start = starts[row];
    let normal = starts[row + 1u].xyz;
    // A direction by the cosine about the normal, in a frame without branches (Duff2017).
    let u = bench_random(pixel);
    let around = 6.2831853 * u.x;
    let side = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (side + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = vec3f(1.0 + side * normal.x * normal.x * a, side * b, -side * normal.x);
    let bitangent = vec3f(b, side + normal.y * normal.y * a, -normal.y);
    let towards = sqrt(u.y) * (cos(around) * tangent + sin(around) * bitangent) + sqrt(1.0 - u.y) * normal;
    let from_surface = start.xyz + 1e-5 * params.reach * normal;
    let t_max = select(-1.0, 3e38, start.w > 0.0);
    var found = 0.0;
    if (KIND == 1u) {
        found = nearest_hit(from_surface, towards, 0.0, t_max).t;
    } else {
        found = f32(any_hit(from_surface, towards, 0.0, t_max));
    }
    if (inside) {
        starts[row + 2u] = vec4f(found);
    }
}

// Two numbers of a pixel, 0 to 1.
fn bench_random(pixel: vec2u) -> vec2f {
    var h = (pixel.x * 1597334677u) ^ (pixel.y * 3812015801u);
    h = (h ^ (h >> 16u)) * 2246822519u;
    h = (h ^ (h >> 13u)) * 3266489917u;
    h = h ^ (h >> 16u);
    let k = h * 747796405u + 2891336453u;
    return vec2f(f32(h >> 8u), f32((k ^ (k >> 15u)) >> 8u)) / 16777216.0;
}
