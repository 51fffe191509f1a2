// Rays from gather points towards what lights shine on.
//! use gather
//! use gather_hit
//! use light_guide

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.reduced.y * params.rays) {
        return;
    }
    let at = vec2u(id.x, id.y % params.reduced.y);
    let start = textureLoad(starts, at, 0);
    let n = textureLoad(normals, at, 0).xyz;
    var found = no_ray();
    if (start.w > 0.0) {
        // A patch by what it sends, then a direction within the cone of its sphere.
        let origin = start.xyz;
        let numbers = ray_numbers(at.x, at.y, params.first_ray + id.y / params.reduced.y);
        var cones: PatchCones;
        let choice = guide_choice(origin, n, numbers.x, &cones);
        let direction = cone_direction(choice.chosen.along, choice.chosen.height, vec2f(choice.number, numbers.y));
        if (choice.total > 0.0 && dot(direction, n) > 0.0) {
            found = gather_hit(origin, direction);
        }
    }
    store_hit(id.xy, found);
}
