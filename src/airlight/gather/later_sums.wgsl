// Adds what later segments brought to what the first ones of a batch of rays met to their points' sums: with the far
// surfaces' light where that is far, and else apart. It is the mean over the paths of a cell, or nearer the path's own.
//! use gather
//! use tone
//! use later_cell

const OTHERS = 1u;          // other paths of a cell whose mean counts
const NEAREST = 0.25;       // sizes of a cell: as near as that a path counts its own light alone
const FARTHER = 1.0;        // sizes: from there on the cell's alone

struct Known {
    light: vec3f,           // W m^-2 sr^-1, of the cell
    share: f32,             // of it, and not of the path's own
}

// The sum over the paths of a cell; w: how many.
fn of_cell(slot: u32) -> vec4f {
    let at = WORDS * slot;
    var sum = vec4f(0.0, 0.0, 0.0, f32(cells[at + COUNT]));
    for (var channel = 0u; channel < 3u; channel++) {
        let words = at + SUMS + 2u * channel;
        sum[channel] = unit[0] * (LOW * f32(cells[words + 1u]) + f32(cells[words]));
    }
    return sum;
}

// What is known of what a ray of so many metres met; `is_own`: its own path is among those of the cell.
fn known_of(p: vec3f, n: vec3f, length_m: f32, is_own: bool) -> Known {
    let cell = later_cell(p, n, params.eye, params.share);
    let share = saturate((length_m / cell.size - NEAREST) / (FARTHER - NEAREST));
    if (share <= 0.0) {
        return Known(vec3f(0.0), 0.0);
    }
    var slot = cell.slot;
    for (var tries = 0u; tries < TRIES; tries++) {
        let name = cells[WORDS * slot + NAME];
        if (name == EMPTY) { break; }
        if (name == cell.name) {
            let sum = of_cell(slot);
            if (sum.w >= f32(OTHERS + u32(is_own))) {
                return Known(sum.rgb / sum.w, share);
            }
            break;
        }
        slot = (slot + 1u) % SLOTS;
    }
    return Known(vec3f(0.0), 0.0);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.reduced)) {
        return;
    }
    let count = params.reduced.x * params.reduced.y;
    let point = id.y * params.reduced.x + id.x;
    let n = textureLoad(normals, id.xy, 0).xyz;
    let start = textureLoad(starts, id.xy, 0);
    var sum = sums[point];
    for (var k = 0u; k < params.rays; k++) {
        // The first segment says where the light comes from, and whether that is far.
        let row = point + k * count;
        let path = paths[2u * row];
        let texel = vec2u(id.x, id.y + k * params.reduced.y);
        let hit = textureLoad(hit_positions, texel, 0);
        if (start.w <= 0.0 || hit.w <= 0.0) {
            continue;
        }
        let is_own = k < params.later;
        let passes = passed[row].rgb;
        let known = known_of(hit.xyz, textureLoad(hit_normals, texel, 0).xyz, distance(hit.xyz, start.xyz), is_own);
        // Of paths that ended no light of their own is known; those that went on count for them.
        let own = select(vec3f(0.0), path.rgb, is_own);
        let light = mix(own, known.light * passes / params.counts, known.share);
        let direction = cosine_direction(n, ray_numbers(id.x, id.y, params.first_ray + k));
        let along = luminance(light) * flux_along(n, direction);
        sum.brightest = max(sum.brightest, luminance(light));
        let is_far = path.w > 0.0 && path.w * far[0] < 1.0;
        sum.far += select(vec3f(0.0), light, is_far);
        sum.far_flux += select(vec3f(0.0), along, is_far);
        sum.later += select(light, vec3f(0.0), is_far);
        sum.later_flux += select(along, vec3f(0.0), is_far);
    }
    sums[point].far = sum.far;
    sums[point].far_flux = sum.far_flux;
    sums[point].later = sum.later;
    sums[point].later_flux = sum.later_flux;
    sums[point].brightest = sum.brightest;
}
