// What rays of a tile's points, orphans too, found beyond what stays with them: for each of these points the mean of it.
//! use gather_tile
//! use orphans
//! use staying_share

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= tiles_of(params.reduced))) {
        return;
    }
    let mean = mean_around(id.xy);
    var light = vec3f(0.0);
    var flux = vec3f(0.0);
    var points = 0.0;
    for (var k = 0u; k < TILE * TILE; k++) {
        let at = TILE * id.xy + vec2u(k % TILE, k / TILE);
        if (any(at >= params.reduced)) { continue; }
        // The block's point, and those of its orphans.
        let orphans_here = orphans_of(at);
        var texel = at;
        var next = orphans_here.first;
        loop {
            if (textureLoad(places, texel, 0).w > 0.0) {
                let own = sums[texel.y * params.reduced.x + texel.x];
                let leaves = 1.0 - staying_share(own, mean);
                light += leaves * (own.near + own.far + own.later);
                flux += leaves * (own.near_flux + own.far_flux + own.later_flux);
                points += 1.0;
            }
            if (next >= orphans_here.end) { break; }
            texel = orphan_texel(next);
            next++;
        }
    }
    textureStore(excess, id.xy, 0, vec4f(light, points));
    textureStore(excess, id.xy, 1, vec4f(flux, 0.0));
}
