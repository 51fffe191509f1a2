// A reflective shadow map (Kaplanyan2010 section 3.1): normal and reflected power of each texel, as a virtual light.
//! use mesh
//! use reflected_power

struct ReflectiveOut {
    @location(0) normal: vec4f,
    @location(1) flux: vec4f,
}

@fragment fn fragment(in: VertexOut, @builtin(front_facing) is_front: bool) -> ReflectiveOut {
    let base = base_color_at(in);
    if (IS_CUTOUT && is_hole(in, base)) {
        discard;
    }
    var out: ReflectiveOut;
    out.normal = vec4f(facing_normal(in, is_front), in.size);
    out.flux = vec4f(reflected_power(present_albedo(in, base, is_front), in.world), 0.0);
    return out;
}
