// Surfels of a view: normal and reflectance of the surface that each texel shows, a layer behind the one before it.
//! use mesh

struct SurfelOut {
    @location(0) normal: vec4f,
    @location(1) reflectance: vec4f,
}

@fragment fn fragment(in: VertexOut, @builtin(front_facing) is_front: bool) -> SurfelOut {
    let base = base_color_at(in);
    if (IS_CUTOUT && is_hole(in, base)) {
        discard;
    }
    // Drawn again, a surface has the same depth to the bit.
    if (params.is_peeled != 0u && in.clip.z <= textureLoad(previous, vec2i(in.clip.xy), 0)) {
        discard;
    }
    var out: SurfelOut;
    out.normal = vec4f(facing_normal(in, is_front), 0.0);
    out.reflectance = vec4f(present_albedo(in, base, is_front), 1.0);
    return out;
}
