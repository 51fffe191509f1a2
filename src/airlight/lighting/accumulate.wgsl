// The running mean of jittered images.

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= params.size)) {
        return;
    }
    let index = id.y * params.size.x + id.x;
    let value = textureLoad(image, vec2i(id.xy), 0);
    // The first image replaces what there was, which may be no number.
    if (params.weight >= 1.0) {
        mean[index] = value;
    } else {
        mean[index] = mix(mean[index], value, params.weight);
    }
}
