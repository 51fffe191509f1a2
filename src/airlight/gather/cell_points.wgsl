// The middles of a lattice's cells as gather points, one after the other in rows of texels; for each, the
// direction to the eye, and by what mean cosine media scatter there.
//! use lattice_space
//! use media
//! use cell_order

const AROUND = 0.75;        // cells
const FARTHER = 1e-3;       // of each step's weight

// The mean cosine of what a cell scatters, or of what the nearest cells do: it is read between their middles.
fn cosine_around(id: vec3u) -> vec3f {
    var scattering = vec3f(0.0);
    var forward = vec3f(0.0);
    for (var k = 0u; k < 27u; k++) {
        let step = vec3f(cell_at_index(vec3u(3u), k)) - 1.0;
        let one = media_coefficients(unwarped_point(lattice, id, 0.5 + AROUND * step));
        let weight = pow(FARTHER, dot(step, step));
        scattering += weight * one.scattering;
        forward += weight * one.forward;
    }
    return forward / max(scattering, vec3f(1e-20));
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let cell = cell_in(lattice.count, id);
    let texel = vec2u((params.first + cell) % params.width, (params.first + cell) / params.width);
    let p = unwarped_point(lattice, id, vec3f(0.5));
    textureStore(places, texel, vec4f(p, 1.0));
    // What the eye sees is before it. So is all of the cell that it is in, seen from a cell behind it.
    let g = cosine_around(id);
    let to_eye = params.eye - lattice.cell * params.ahead - p;
    let towards = to_eye / max(length(to_eye), 1e-6);
    textureStore(axes, texel, vec4f(towards, dot(g, vec3f(1.0 / 3.0))));
    textureStore(cosines, texel, vec4f(g, 0.0));
}
