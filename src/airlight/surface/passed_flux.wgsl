//! use mesh

// The colour of light that passes a translucent surface: where it does not pass, the map shows the surface by chance
// (`is_hole`), so that the mean of all channels is right already.

@fragment fn fragment(in: VertexOut) -> @location(0) vec4f {
    let base = base_color_at(in);
    if (IS_CUTOUT && base.a < materials[in.material].alpha_cutoff) {
        discard;
    }
    let passed = passed_head_on(in, base);
    return vec4f(passed / max(mean_channel(passed), 1e-4), 1.0);
}
