// Adds what the later segments of a batch of paths brought to the cells of what their first ones met.
//! use later_cell

// The slot of the cell, taken where it is new; SLOTS where all that it may have are others'.
fn taken(cell: LaterCell) -> u32 {
    var slot = cell.slot;
    var tries = 0u;
    loop {
        if (tries >= TRIES) { break; }
        let was = atomicCompareExchangeWeak(&cells[WORDS * slot + NAME], EMPTY, cell.name);
        if (was.exchanged || was.old_value == cell.name) {
            return slot;
        }
        // An exchange may also fail for no reason: then it is tried again.
        if (was.old_value != EMPTY) {
            slot = (slot + 1u) % SLOTS;
            tries++;
        }
    }
    return SLOTS;
}

// Sums are of fixed point, in two words: they do not depend on the order.
fn words_of(value: f32) -> vec2u {
    let units = clamp(value, 0.0, 1e18);
    let high = floor(units / LOW);
    return vec2u(u32(units - high * LOW), u32(high));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.reduced.y * params.later) {
        return;
    }
    let hit = textureLoad(hit_positions, id.xy, 0);
    let row = id.y * params.reduced.x + id.x;
    let passes = passed[row].rgb;
    // What a surface does not reflect is not known to have come.
    let brightest = max(passes.r, max(passes.g, passes.b));
    if (hit.w <= 0.0 || min(passes.r, min(passes.g, passes.b)) <= 1e-3 * brightest || unit[0] <= 0.0) {
        return;
    }
    let cell = later_cell(hit.xyz, textureLoad(hit_normals, id.xy, 0).xyz, params.eye, params.share);
    let slot = taken(cell);
    if (slot == SLOTS) {
        return;
    }
    let light = paths[2u * row].rgb / (passes * unit[0]);
    atomicAdd(&cells[WORDS * slot + COUNT], 1u);
    for (var channel = 0u; channel < 3u; channel++) {
        let added = words_of(light[channel]);
        let at = WORDS * slot + SUMS + 2u * channel;
        let before = atomicAdd(&cells[at], added.x);
        atomicAdd(&cells[at + 1u], added.y + u32(before + added.x < before));
    }
}
