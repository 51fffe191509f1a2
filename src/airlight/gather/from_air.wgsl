// Rays from points in the air, half of them into all directions alike, half where media scatter towards the eye
// from; each writes the surface that it meets.
//! use gather
//! use gather_hit

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.reduced.y * params.rays) {
        return;
    }
    // Texels of one ray lie below those of the ray before it.
    let at = vec2u(id.x, id.y % params.reduced.y);
    let place = textureLoad(places, at, 0);
    var found = no_ray();
    if (place.w > 0.0) {
        let ray = params.first_ray + id.y / params.reduced.y;
        let axis = textureLoad(normals, at, 0);
        // Light travels against the ray that finds it.
        let direction = lobe_direction(-axis.xyz, axis.w, ray_numbers(at.x, at.y, ray));
        found = gather_hit(place.xyz, direction);
    }
    keep_hit(id.xy, found);
}
