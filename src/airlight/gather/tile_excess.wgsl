// What rays of a tile's points found beyond what stays with them: for each of the points the mean of it.
//! use gather_tile
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
        if (all(at < params.reduced) && textureLoad(places, at, 0).w > 0.0) {
            let own = sums[at.y * params.reduced.x + at.x];
            let leaves = 1.0 - staying_share(own, mean);
            light += leaves * (own.near + own.far + own.later);
            flux += leaves * (own.near_flux + own.far_flux + own.later_flux);
            points += 1.0;
        }
    }
    textureStore(excess, id.xy, 0, vec4f(light, points));
    textureStore(excess, id.xy, 1, vec4f(flux, 0.0));
}
