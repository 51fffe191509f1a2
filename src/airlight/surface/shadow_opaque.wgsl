//! use mesh_vertex

@vertex fn vertex(in: VertexIn) -> VertexOut {
    return placed_vertex(in, params.clip_from_world);
}
