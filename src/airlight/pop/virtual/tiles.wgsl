// The weight of a tile: the sum of those of its texels.
//! use reflecting_texel

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let side = params.side;
    if (id.x >= side * side * params.layers) {
        return;
    }
    let first = TILE * vec2u(id.x % side, (id.x / side) % side);
    let layer = id.x / (side * side);
    // Tiles at the far sides of a map reach beyond it.
    var sum = 0.0;
    for (var k = 0u; k < TILE * TILE; k++) {
        let texel = first + vec2u(k % TILE, k / TILE);
        if (all(texel < vec2u(params.resolution))) {
            sum += reflecting(texel, layer).weight;
        }
    }
    tiles[params.first_tile + id.x] = sum;
}
