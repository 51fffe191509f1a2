// The flux of reflective shadow maps, attenuated by media from the light to each texel.
//! use light_texel
//! use media_light

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.resolution || id.y >= params.resolution || id.z >= params.layers) {
        return;
    }
    let texel = vec2i(id.xy);
    let power = textureLoad(flux, texel, id.z, 0);
    let d = textureLoad(depth, texel, id.z, 0);
    // From the light to the point of the texel, through all media.
    let p = texel_point(row_of_views(id.z), texel_centre(id.xy, params.resolution), d);
    let owner = owners[id.z];
    let passed = media_light_transmittance(row_of_lights(owner), owner, p);
    textureStore(attenuated, texel, id.z, vec4f(power.rgb * passed, power.a));
}
