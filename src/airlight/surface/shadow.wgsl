//! use mesh

// The depth of materials with holes: what is not there casts no shadow.

@fragment fn fragment(in: VertexOut) {
    if (IS_CUTOUT && is_hole(in, base_color_at(in))) {
        discard;
    }
}
