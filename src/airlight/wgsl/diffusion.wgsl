//! use medium_grid
//! use walls
//! needs fn absorbing(cell: u32) -> vec3f
//! needs fn transporting(cell: u32) -> vec3f

// Diffusion on a medium's cells; see maths/diffusion.py. The including pass binds `params`
// (MediumParams) and what wgsl/one_medium_cells.wgsl or mixed_media_cells.wgsl ask for.

fn diffusivity(cell: u32) -> vec3f {
    return 1.0 / max(3.0 * transporting(cell), vec3f(1.0 / params.largest_diffusivity));
}

// J outwards through an inner face. `carried`: half the sum of both cells' forward power per volume
// along the outward normal.
fn inner_flux(d0: vec3f, d1: vec3f, step: vec3f, carried: vec3f, h: f32) -> vec3f {
    let between = 2.0 * d0 * d1 / (d0 + d1);
    return between * (step / h + 3.0 * carried);
}

// J outwards through a face of the box, from which nothing comes back (`reflectance` 0), or onto a surface, which
// reflects a share of what arrives to all sides.
fn outer_flux(d: vec3f, phi: vec3f, carried: vec3f, h: f32, reflectance: f32) -> vec3f {
    let half = 0.5 * h / d;
    return (phi + half * 3.0 * d * carried) / (half + 2.0 * (1.0 + reflectance) / (1.0 - reflectance));
}

fn is_outer(cell: vec3u, axis: u32, side: u32) -> bool {
    return select(cell[axis] == 0u, cell[axis] + 1u == params.count[axis], side == 1u);
}

// Whether light that goes out through a face is gone: the box ends there, or a surface stands before the next cell.
// `faces`: of the cell, as wgsl/walls.wgsl has them.
fn is_closed(faces: u32, cell: vec3u, axis: u32, side: u32) -> bool {
    return is_outer(cell, axis, side) || is_walled(faces, axis, side);
}

fn beside(index: u32, axis: u32, side: u32) -> u32 {
    return select(index - cell_stride(axis), index + cell_stride(axis), side == 1u);
}

// A's diagonal, m^-1.
fn diffusion_diagonal(index: u32, faces: u32, reflecting: u32) -> vec3f {
    let cell = cell_of(index);
    let d = diffusivity(index);
    var sum = absorbing(index);
    for (var face = 0u; face < 6u; face++) {
        let axis = face / 2u;
        let h = params.cell[axis];
        if (is_closed(faces, cell, axis, face & 1u)) {
            sum += outer_flux(d, vec3f(1.0), vec3f(0.0), h, wall_reflectance(reflecting, axis, face & 1u)) / h;
        } else {
            let other = diffusivity(beside(index, axis, face & 1u));
            sum += inner_flux(d, other, vec3f(1.0), vec3f(0.0), h) / h;
        }
    }
    return sum;
}
