// The lists of some blocks for one light: a bit for each medium that lies between any point of a block and it.
//! use media_tree
//! use wider_box
//! use cell_order

const WIDER = 1.001;    // blocks overlap a little, whatever rounding makes of a point between two

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let n = params.blocks;
    let blocks = n.x * n.y * n.z;
    let apart = (blocks + LISTS_AT_ONCE - 1u) / LISTS_AT_ONCE;
    if (id.x >= apart || id.y >= params.lights) {
        return;
    }
    // Blocks fill the box of all media, the root of their tree.
    let all = media_node(0u);
    let side = (all.high - all.low) / vec3f(n);
    let light = path_lights[id.y];
    var centres: array<vec3f, LISTS_AT_ONCE>;
    for (var k = 0u; k < LISTS_AT_ONCE; k++) {
        let block = id.x + k * apart;
        let cell = cell_at_index(n, block);
        centres[k] = all.low + (vec3f(cell) + 0.5) * side;
    }
    // A medium is loaded once and asked for by all blocks.
    for (var texel = 0u; texel < PATH_TEXELS; texel++) {
        var bits: array<vec4u, LISTS_AT_ONCE>;
        let end = min(128u * (texel + 1u), params.media);
        for (var m = 128u * texel; m < end; m++) {
            let from_world = row_of_media(m).volume_from_world;
            let axes = mat3x3f(from_world[0].xyz, from_world[1].xyz, from_world[2].xyz);
            let half = 0.5 * mat3x3f(abs(axes[0]), abs(axes[1]), abs(axes[2])) * (WIDER * side);
            let bit = select(vec4u(0u), vec4u(1u << (m & 31u)), vec4u(0u, 1u, 2u, 3u) == vec4u((m >> 5u) & 3u));
            for (var k = 0u; k < LISTS_AT_ONCE; k++) {
                let o = axes * centres[k] + from_world[3].xyz;
                let to_light = axes * select(light.towards, light.towards - centres[k], light.is_local != 0u);
                let reach = select(3.0e38, 1.0, light.is_local != 0u);
                // From anywhere in a block light may meet the box where the ray from its centre meets a wider one.
                bits[k] |= select(vec4u(0u), bit, meets_wider_box(o, to_light, reach, half));
            }
        }
        // A texel holds the bits of 128 media; those of a light lie one behind the other along z.
        for (var k = 0u; k < LISTS_AT_ONCE; k++) {
            let block = id.x + k * apart;
            if (block < blocks) {
                let at = vec3u(block % (n.x * n.y), block / (n.x * n.y), id.y * PATH_TEXELS + texel);
                textureStore(lists, at, bits[k]);
            }
        }
    }
}
