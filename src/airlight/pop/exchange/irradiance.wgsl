//! use medium_grid
//! use other_media
//! use phase

// What arrives in a cell, but for what the own box takes of it, of a block of another medium.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= way.blocks) {
        return;
    }
    let first = 5u * id.y;
    let power = blocks[first];
    if (reach[id.x] == 0u || all(power.rgb <= vec3f(0.0))) {
        given[id.y * params.cells + id.x] = vec4f(0.0);
        return;
    }
    let point = cell_centre(cell_of(id.x));
    let row = params.ordinate_count - way.blocks + id.y;
    let away = point - ordinates[row].position.xyz;
    let r = max(length(away), 1e-9);
    let travel = away / r;
    let blunt = r * r + power.a;
    let x = blocks[first + 1u].rgb;
    let y = blocks[first + 2u].rgb;
    let z = blocks[first + 3u].rgb;
    let size = max(sqrt(x * x + y * y + z * z), vec3f(1e-20));
    let mu = clamp((x * travel.x + y * travel.y + z * travel.z) / size, vec3f(-1.0), vec3f(1.0));
    let lobe = min(size / max(power.rgb, vec3f(1e-20)), vec3f(0.98)) * r * inverseSqrt(blunt);
    let intensity = power.rgb * vec3f(henyey_greenstein(mu.r, lobe.r),
        henyey_greenstein(mu.g, lobe.g), henyey_greenstein(mu.b, lobe.b));
    let inside = max(0.0, ray_box_interval(point, -travel, vec3f(0.0), params.extent).y);
    var depth = vec3f(0.0);
    for (var m = 1u; m < MEDIA; m++) {
        depth += media[m].sigma_t * density_between(m, point, -travel, inside, r);
    }
    // Of a thick block the near part shows.
    let half = 0.5 * min(blocks[first + 4u].rgb, vec3f(20.0));
    let grown = exp(max(half, vec3f(0.05)));
    let mean = select((grown - 1.0 / grown) / (2.0 * max(half, vec3f(0.05))), vec3f(1.0),
        half < vec3f(0.05));
    let passed = min(exp(-depth) * mean, vec3f(1.0));
    let arrives = intensity * passed * seen[id.y * params.cells + id.x];
    given[id.y * params.cells + id.x] = vec4f(arrives / blunt, 0.0);
}
