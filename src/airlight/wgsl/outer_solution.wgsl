//! use diffusion
//! use cell_order

// Diffuse light that enters a finer grid from the solution of the next larger one; see
// maths/nested_diffusion.py. The including pass binds `outer` (OuterParams), `outer_phi` and
// `outer_diffuse` ([Phi, Jx, Jy, Jz] per cell), and what wgsl/diffusion.wgsl asks for.

// What comes in at a point of the border, four times the partial current; 0 outside the larger grid.
fn entering_fluence(point: vec3f, axis: u32, outwards: f32) -> vec3f {
    let q = point + outer.offset;
    let extent = outer.cell * vec3f(outer.count);
    let slack = 1e-4 * outer.cell;
    if (any(q < -slack) || any(q > extent + slack)) {
        return vec3f(0.0);
    }
    // Between eight cells of the outer grid: what of their fluence and flux comes in (Marshak's border).
    let at = clamp(q / outer.cell - 0.5, vec3f(0.0), vec3f(outer.count) - 1.0);
    let low = min(vec3u(at), outer.count - 2u);
    let share = at - vec3f(low);
    var sum = vec3f(0.0);
    for (var s = 0u; s < 8u; s++) {
        let side = vec3u(s & 1u, (s >> 1u) & 1u, s >> 2u);
        let weights = mix(1.0 - share, share, vec3f(side));
        let c = low + side;
        let index = cell_in(outer.count, c);
        let flux = outer_diffuse[(1u + axis) * outer.cells + index].xyz;
        sum += weights.x * weights.y * weights.z
            * (outer_phi[index].xyz - 2.0 * outwards * flux);
    }
    return sum;
}

// The flux inwards through a face of a cell, W m^-2; 0 through inner faces.
fn entering_flux(index: u32, axis: u32, side: u32) -> vec3f {
    let cell = cell_of(index);
    if (!is_outer(cell, axis, side)) {
        return vec3f(0.0);
    }
    let outwards = select(-1.0, 1.0, side == 1u);
    let h = params.cell[axis];
    var point = cell_centre(cell);
    point[axis] += 0.5 * outwards * h;
    return entering_fluence(point, axis, outwards) / (0.5 * h / diffusivity(index) + 2.0);
}
