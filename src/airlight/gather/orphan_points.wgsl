// Gather points of the listed orphan pixels, in the rows below those of the blocks.
//! use gather_point
//! use orphans

override HAS_OCCLUSION: bool = false;

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let k = id.y * params.reduced.x + id.x;
    if (id.x >= params.reduced.x || k >= params.most) {
        return;
    }
    var found: GatherPoint;
    let word = orphans[blocks_of_image() + k];
    let texel = orphan_texel(k);
    if (word != NO_ORPHAN) {
        let within = word >> BLOCK_BITS;
        let pixel = block_of(texel) * params.scale + vec2u(within % params.scale, within / params.scale);
        found = gather_point(pixel, textureLoad(depth, pixel, 0));
    }
    textureStore(places, texel, found.place);
    textureStore(starts, texel, found.start);
    textureStore(normals, texel, found.facing);
    textureStore(planes, texel, found.plane);
}
