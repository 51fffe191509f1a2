//! use mesh

override IS_CUTOUT: bool = false;

@vertex fn vertex(in: VertexIn, at: InstanceTransform) -> VertexOut {
    return transformed_vertex(in, at, params.clip_from_world);
}

@fragment fn fragment(in: VertexOut) {
    if (IS_CUTOUT && is_hole(in, base_color_at(in))) {
        discard;
    }
}
