// One layer of translucent surfaces: the nearest behind those already taken, as the G-buffer has surfaces.
//! use half_range
//! use mesh

struct LayerOut {
    @location(0) albedo: vec4f,
    @location(1) normal: vec4f,
    @location(2) emission: vec4f,
    @location(3) taken: vec4f,
}

@fragment fn fragment(in: VertexOut, @builtin(front_facing) is_front: bool) -> LayerOut {
    let pixel = vec2i(in.clip.xy);
    let point = shown_point(in, is_front, params.unlit_radiance);
    let m = materials[in.material];
    if (IS_CUTOUT && point.alpha < m.alpha_cutoff) {
        discard;
    }
    // Depth is reversed: what is nearer has more. Drawn again, a surface has the same to the bit.
    let is_peeled = params.is_first == 0u && in.clip.z >= textureLoad(before, pixel, 0);
    if (is_peeled || in.clip.z < textureLoad(solid, pixel, 0)) {
        discard;
    }
    let to_eye = normalize(params.eye - in.world);
    let base = base_color_at(in);
    let there = coverage(point.alpha, m.is_blended != 0u);
    var out: LayerOut;
    // Of what is there, the part that passes is no diffuse albedo.
    out.albedo = vec4f(point.base_color * (1.0 - transmission_at(in)), point.metallic);
    out.normal = vec4f(point.normal, point.roughness);
    out.emission = vec4f(in_half_range(point.emission), point.specular);
    out.taken = vec4f(1.0 - passed_at(in, base, point.normal, to_eye), there);
    return out;
}
