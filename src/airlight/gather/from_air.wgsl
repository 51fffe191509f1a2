// Rays from points in the air, half of them into all directions alike, half where media scatter towards the eye
// from, or a part towards what lights shine on; each writes the surface that it meets.
//! use guide_air
//! use gather_hit

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.reduced.y * params.rays) {
        return;
    }
    // Texels of one ray lie below those of the ray before it.
    let at = vec2u(id.x, id.y % params.reduced.y);
    let start = textureLoad(starts, at, 0);
    var found = no_ray();
    if (start.w > 0.0) {
        let ray = params.first_ray + id.y / params.reduced.y;
        let axis = textureLoad(normals, at, 0);
        // Light travels against the ray that finds it.
        found = gather_hit(start.xyz, air_ray(start.xyz, axis, ray_numbers(at.x, at.y, ray)).direction);
    }
    store_hit(id.xy, found);
}
