// All light in cells for rays that surfaces send: the solved track, and the unscattered light beside
// it as reduced media attenuate it; that as the media themselves do, and where it goes.
//! use cell_order
//! use half_range

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= params.count)) {
        return;
    }
    let cells = params.count.x * params.count.y * params.count.z;
    let cell = cell_in(params.count, id);
    let scattered = max(vec3f(track[cell].x, track[cell + cells].x, track[cell + 2u * cells].x),
        vec3f(0.0));
    // Track, W m, over a cell's volume is fluence.
    let whole = params.share * scattered + params.volume * light[3u * cell].rgb;
    let alone = params.volume * light[3u * cell + 1u].rgb;
    let going = params.volume * light[3u * cell + 2u].rgb;
    let texel = id + vec3u(0u, params.first_row, 0u);
    textureStore(mean, texel, vec4f(in_half_range(whole * params.scale), 1.0));
    textureStore(straight, texel, vec4f(in_half_range(alone * params.scale), 1.0));
    textureStore(along, texel, vec4f(clamp(going * params.scale, vec3f(-LARGEST_HALF), vec3f(LARGEST_HALF)), 1.0));
}
