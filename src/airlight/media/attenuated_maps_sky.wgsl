// The flux of the sky's maps, attenuated likewise.
//! use light_texel
//! use media

// The sky's lights shine along their maps' depth, from beyond where a texel's ray begins.
@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.resolution || id.y >= params.resolution || id.z >= params.layers) {
        return;
    }
    let texel = vec2i(id.xy);
    let power = textureLoad(flux, texel, id.z, 0);
    let d = textureLoad(depth, texel, id.z, 0);
    let uv = texel_centre(id.xy, params.resolution);
    // Along the map's depth, from as far before the map as media may lie.
    var passed = vec3f(1.0);
    if (any(power.rgb > vec3f(0.0))) {
        let start = texel_point(row_of_views(id.z), uv, 0.0);
        let along = normalize(texel_point(row_of_views(id.z), uv, 1.0) - start);
        passed = media_transmittance(start - params.beyond * along, texel_point(row_of_views(id.z), uv, d));
    }
    textureStore(attenuated, texel, id.z, vec4f(power.rgb * passed, power.a));
}
