// The sums of points, once all of their rays are in them, as an image that neighbours read: without what single rays
// have found by luck, and with a part of what those around have.
//! use gather_tile
//! use staying_share
//! use orphans
//! use stored_sums

// What a point gets of what does not stay with those around: light, and where that comes from. Of a box of three tiles,
// faded over one.
fn given(block: vec2u) -> mat2x3f {
    let last = vec2i(tiles_of(params.reduced)) - 1;
    let at = (vec2f(block) + 0.5) / f32(TILE) - 0.5;
    var light = vec4f(0.0);
    var flux = vec3f(0.0);
    for (var k = 0; k < 16; k++) {
        let tile = vec2i(floor(at)) + vec2i(k % 4, k / 4) - 1;
        let away = saturate(2.0 - abs(vec2f(tile) - at));
        if (all(tile >= vec2i(0)) && all(tile <= last)) {
            light += away.x * away.y * textureLoad(excess, tile, 0, 0);
            flux += away.x * away.y * textureLoad(excess, tile, 1, 0).xyz;
        }
    }
    return mat2x3f(light.xyz, flux) * (1.0 / max(light.w, 1.0));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.reduced.x || id.y >= params.rows) {
        return;
    }
    var found = sums[id.y * params.reduced.x + id.x];
    let block = block_of(id.xy);
    let stays = staying_share(found, mean_around(block / TILE));
    let more = given(block);
    found.near = stays * found.near + more[0];
    found.near_flux = stays * found.near_flux + more[1];
    found.far *= stays;
    found.far_flux *= stays;
    found.later *= stays;
    found.later_flux *= stays;
    store_sums(id.xy, found);
}
