// One more ray from each surface that a ray has met.
//! use gather
//! use gather_hit

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.reduced.y * params.rays) {
        return;
    }
    let place = textureLoad(places, id.xy, 0);
    let n = textureLoad(normals, id.xy, 0).xyz;
    var found = no_ray();
    if (place.w > 0.0) {
        // Texels of one ray lie below those of the ray before it.
        let ray = params.first_ray + id.y / params.reduced.y;
        let y = id.y % params.reduced.y;
        let direction = cosine_direction(n, later_numbers(id.x, y, ray, params.segment));
        found = gather_hit(place.xyz + params.raised * n, direction);
    }
    textureStore(hit_positions, id.xy, found.position);
    textureStore(hit_normals, id.xy, found.normal);
    textureStore(hit_albedos, id.xy, found.albedo);
}
