// The irradiance of a block of another medium in a cell, before the medium's own box attenuates it.
//! use medium_grid
//! use other_media
//! use phase

const LARGEST_LOBE = 0.98;      // mean cosine

// A block's radiant intensity towards `travel`, W sr^-1, at `r` metres: Henyey-Greenstein about its
// net flux. The mean cosine is net flux over power, less for the width of the block (`blunt`, m^2:
// r^2 and its squared radius).
fn block_intensity(first: u32, travel: vec3f, r: f32, blunt: f32) -> vec3f {
    let power = blocks[first].rgb;
    let x = blocks[first + 1u].rgb;
    let y = blocks[first + 2u].rgb;
    let z = blocks[first + 3u].rgb;
    let size = max(sqrt(x * x + y * y + z * z), vec3f(1e-20));
    let mu = clamp((x * travel.x + y * travel.y + z * travel.z) / size, vec3f(-1.0), vec3f(1.0));
    let lobe = min(size / max(power, vec3f(1e-20)), vec3f(LARGEST_LOBE)) * r * inverseSqrt(blunt);
    return power * vec3f(henyey_greenstein(mu.r, lobe.r), henyey_greenstein(mu.g, lobe.g),
        henyey_greenstein(mu.b, lobe.b));
}

// Mean of exp(-depth) over a block of optical depth 2 `half`, over that in its middle: the near
// part of a thick block shows.
fn block_gain(half: vec3f) -> vec3f {
    let grown = exp(max(half, vec3f(0.05)));
    return select((grown - 1.0 / grown) / (2.0 * max(half, vec3f(0.05))), vec3f(1.0),
        half < vec3f(0.05));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.cells || id.y >= exchange.blocks) {
        return;
    }
    let first = 5u * id.y;
    let power = blocks[first];
    if (reach[id.x] == 0u || all(power.rgb <= vec3f(0.0))) {
        inter_medium[id.y * params.cells + id.x] = vec4f(0.0);
        return;
    }
    // The block's radiant intensity towards the cell; its own width blunts the fall-off.
    let point = cell_centre(cell_of(id.x));
    let row = params.ordinate_count - exchange.blocks + id.y;
    let away = point - ordinates[row].position.xyz;
    let r = max(length(away), 1e-9);
    let travel = away / r;
    let blunt = r * r + power.a;
    let intensity = block_intensity(first, travel, r, blunt);
    // The other media attenuate it outside the medium's box.
    let inside = max(0.0, ray_box_interval(point, -travel, vec3f(0.0), params.extent).y);
    var depth = vec3f(0.0);
    for (var m = 1u; m < MEDIA; m++) {
        depth += row_of_media(m).sigma_t * density_between(m, point, -travel, inside, r);
    }
    let gain = block_gain(0.5 * min(blocks[first + 4u].rgb, vec3f(20.0)));
    let transmittance = min(exp(-depth) * gain, vec3f(1.0));
    let arrives = intensity * transmittance * seen[id.y * params.cells + id.x];
    inter_medium[id.y * params.cells + id.x] = vec4f(arrives / blunt, 0.0);
}
