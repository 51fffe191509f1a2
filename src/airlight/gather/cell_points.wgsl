// The middles of a lattice's cells as gather points, one after the other in rows of texels; for each, the
// direction to the eye, and by what mean cosine media scatter there.
//! use lattice_space
//! use media

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let cell = (id.z * lattice.count.y + id.y) * lattice.count.x + id.x;
    let texel = vec2u((params.first + cell) % params.width, (params.first + cell) / params.width);
    let p = unwarped_point(lattice, id, vec3f(0.5));
    textureStore(places, texel, vec4f(p, 1.0));
    // What the eye sees is before it. So is all of the cell that it is in, seen from a cell behind it.
    let g = media_mean_cosine(p);
    let way = params.eye - lattice.cell * params.ahead - p;
    let towards = way / max(length(way), 1e-6);
    textureStore(axes, texel, vec4f(towards, dot(g, vec3f(1.0 / 3.0))));
    textureStore(cosines, texel, vec4f(g, 0.0));
}
