// Rays from gather points into all directions, by the cosine; each writes the surface that it meets.
//! use gather
//! use gather_hit

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.reduced.y * params.rays) {
        return;
    }
    let at = vec2u(id.x, id.y % params.reduced.y);
    let start = textureLoad(starts, at, 0);
    let n = textureLoad(normals, at, 0).xyz;
    var found = no_ray();
    if (start.w > 0.0) {
        // By the cosine about the normal, so that irradiance is pi times a mean of radiance.
        let ray = params.first_ray + id.y / params.reduced.y;
        let direction = cosine_direction(n, ray_numbers(at.x, at.y, ray));
        found = gather_hit(start.xyz, direction);
    }
    store_hit(id.xy, found);
}
