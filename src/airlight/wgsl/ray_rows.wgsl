// Rows of four words of the hierarchies (rays/words.py), as the textures of RAY_SLOTS hold them (rays/rows.py).

const RAY_LINE_BITS = 12u;      // of the number of rows in a line of a texture

fn ray_texel(row: u32) -> vec2u {
    return vec2u(row & ((1u << RAY_LINE_BITS) - 1u), row >> RAY_LINE_BITS);
}

fn ray_node_row(row: u32) -> vec4u {
    return textureLoad(ray_nodes, ray_texel(row), 0);
}

fn ray_triangle_row(row: u32) -> vec4u {
    return textureLoad(ray_triangles, ray_texel(row), 0);
}

fn ray_instance_row(row: u32) -> vec4u {
    return textureLoad(ray_instances, ray_texel(row), 0);
}
