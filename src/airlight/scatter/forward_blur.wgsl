// Each light's forward light over blocks of cells; the slabs of both textures along z are lights.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let blocks = (params.count + BLOCK - 1u) / BLOCK;
    let size = vec3u(blocks.xy, blocks.z * params.lights);
    if (any(id >= size)) {
        return;
    }
    let light = id.z / blocks.z;
    let first = vec3u(id.xy, id.z % blocks.z) * BLOCK;
    let end = min(first + BLOCK, params.count);
    var sum = vec4f(0.0);
    var counted = 0.0;
    for (var z = first.z; z < end.z; z++) {
        for (var y = first.y; y < end.y; y++) {
            for (var x = first.x; x < end.x; x++) {
                sum += textureLoad(kept, vec3u(x, y, z + light * params.count.z), 0);
                counted += 1.0;
            }
        }
    }
    textureStore(blurred, id, sum / max(counted, 1.0));
}
