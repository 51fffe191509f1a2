// What the rays of a tile of points found of surfaces' light, added up: luminance, and how many they were.
//! use gather_tile

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= tiles_of(params.reduced))) {
        return;
    }
    var sum = 0.0;
    var rays = 0.0;
    for (var k = 0u; k < TILE * TILE; k++) {
        let at = TILE * id.xy + vec2u(k % TILE, k / TILE);
        // Points without a surface send none.
        if (all(at < params.reduced) && textureLoad(places, at, 0).w > 0.0) {
            sum += surface_luminance(sums[at.y * params.reduced.x + at.x]);
            rays += f32(params.rays);
        }
    }
    textureStore(tile_sums, id.xy, vec4f(sum, rays, 0.0, 0.0));
}
