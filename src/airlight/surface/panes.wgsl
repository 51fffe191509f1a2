//! use mesh

// The transmittance of a translucent surface towards a light, and how far from it the surface is.

@fragment fn fragment(in: VertexOut) -> @location(0) vec4f {
    let base = base_color_at(in);
    let m = materials[in.material];
    if (IS_CUTOUT && base.a < m.alpha_cutoff) {
        discard;
    }
    // Towards a directional light all directions are the same.
    let to_light = select(-params.origin, params.origin - in.world, params.is_perspective != 0u);
    let passed = passed_at(in, base, normalize(in.normal), normalize(to_light));
    return vec4f(passed, select(in.clip.z, 1.0 / in.clip.w, params.is_perspective != 0u));
}
