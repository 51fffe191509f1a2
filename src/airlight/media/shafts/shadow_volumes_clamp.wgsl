// Where all is shadowed, the sums end a little below or above zero: they are clamped.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(summed))) {
        return;
    }
    // Light in front of faces less what lies behind them: rounding may leave less than nothing.
    let light = textureLoad(summed, vec2i(id.xy), 0);
    textureStore(scattered, id.xy, vec4f(max(light.rgb, vec3f(0.0)), 1.0));
}
