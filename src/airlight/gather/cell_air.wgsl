// All light in cells for the rays of the next sample: what rays found, and the unscattered light beside it.
//! use cell_order
//! use tone
//! use half_range

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id >= lattice.count)) {
        return;
    }
    let cell = params.first + cell_in(lattice.count, id);
    let texel = id + vec3u(0u, lattice.first_row, 0u);
    // Scattered light as rays found it, in the texture's unit, and light that did not scatter.
    let whole = params.scale * before[2u * cell].rgb + textureLoad(straight, texel, 0).rgb;
    textureStore(air, texel, vec4f(in_half_range(whole), 1.0));
    // Where scattered light goes, and its luminance.
    let along = params.scale * vec4f(before[2u * cell + 1u].rgb, luminance(before[2u * cell].rgb));
    textureStore(scattered_along, texel, within_half_range(along));
}
