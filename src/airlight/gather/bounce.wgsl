// One more ray from each surface that a ray has met: by the cosine, or towards what lights shine on.
//! use gather
//! use gather_hit
//! use light_guide

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.reduced.y * params.rays) {
        return;
    }
    let start = textureLoad(starts, id.xy, 0);
    let n = textureLoad(normals, id.xy, 0).xyz;
    var found = no_ray();
    if (start.w > 0.0) {
        // Texels of one ray lie below those of the ray before it.
        let ray = params.first_ray + id.y / params.reduced.y;
        let y = id.y % params.reduced.y;
        let origin = start.xyz + params.raised * n;
        let numbers = later_numbers(id.x, y, ray, params.segment);
        var direction = cosine_direction(n, numbers);
        // A part of the second number chooses whether a patch leads the ray.
        if (has_guide()) {
            var cones: PatchCones;
            let choice = guide_choice(origin, n, numbers.x, &cones);
            let one = led(choice, numbers.y);
            direction = cosine_direction(n, vec2f(numbers.x, one.rest));
            if (one.is_led) {
                direction = cone_direction(choice.chosen.along, choice.chosen.height, vec2f(choice.number, one.rest));
            }
            // What the path counts, both ways to choose its direction know (Veach1995, the balance heuristic).
            let cosine = max(dot(direction, n), 0.0) / 3.14159265;
            let density = one.part * density_of_cones(&cones, choice.total, direction);
            let counts = cosine / max((1.0 - one.part) * cosine + density, 1e-30);
            let row = 2u * (id.y * params.reduced.x + id.x) + 1u;
            paths[row] = vec4f(counts * paths[row].rgb, paths[row].w);
        }
        if (dot(direction, n) > 0.0) {
            found = gather_hit(origin, direction);
        }
    }
    store_hit(id.xy, found);
}
