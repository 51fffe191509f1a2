// The G-buffer: what lighting needs of the nearest surface in each pixel.
//! use half_range
//! use mesh

struct GBufferOut {
    @location(0) albedo: vec4f,
    @location(1) normal: vec4f,
    @location(2) emission: vec4f,
}

@fragment fn fragment(in: VertexOut, @builtin(front_facing) is_front: bool) -> GBufferOut {
    let point = shown_point(in, is_front, params.unlit_radiance);
    if (IS_CUTOUT && point.alpha < materials[in.material].alpha_cutoff) {
        discard;
    }
    var out: GBufferOut;
    out.albedo = vec4f(point.base_color, point.metallic);
    out.normal = vec4f(point.normal, point.roughness);
    out.emission = vec4f(in_half_range(point.emission), point.specular);
    return out;
}
