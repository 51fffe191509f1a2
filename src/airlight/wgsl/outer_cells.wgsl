// Where the larger lattice around a finer one, `outer`, is read for the light that enters the finer one.
// The including pass binds `outer` (LatticeParams) and what `lattice_space` needs, with
// lattice_visibility_a/b: nested lattices share these textures.
//! use lattice_space

// Between cells only where all is open: beyond a wall may be sunlight, of which a hundredth is
// more than all the light in a room.
fn outer_fraction(offset: f32, open_low: f32, open_high: f32) -> f32 {
    return offset * smoothstep(0.7, 1.0, select(open_low, open_high, offset > 0.0));
}

// Warped coordinates at which the larger lattice is interpolated, for a place in its cells.
fn outer_place(coordinates: vec3f) -> vec3f {
    let warped = warped_in_cells(outer, coordinates);
    let cell = clamp(floor(warped), vec3f(0.0), vec3f(outer.count) - 1.0);
    let texel = lattice_texel(outer, vec3i(cell));
    let xy = textureLoad(lattice_visibility_a, texel, 0);
    let z = textureLoad(lattice_visibility_b, texel, 0);
    let t = clamp(warped - cell, vec3f(0.0), vec3f(1.0)) - 0.5;
    return cell + 0.5 + vec3f(outer_fraction(t.x, xy.x, xy.y), outer_fraction(t.y, xy.z, xy.w),
        outer_fraction(t.z, z.x, z.y));
}
