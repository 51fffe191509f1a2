//! use diffusion
//! use partial_sums

@compute @workgroup_size(WX, WY, WZ) fn main(
    @builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    let now = whole_sum(RZ + (iteration.step & 1u), lane);
    let last = whole_sum(RZ + (~iteration.step & 1u), lane);
    let beta = select(quotient(now, last), vec3f(0.0), iteration.step == 0u);
    var product_sum = vec3f(0.0);
    if (id.x < params.cells) {
        let index = id.x;
        let cell = cell_of(index);
        let rho = density[index];
        let d = diffusivity(rho);
        let p = z[index].xyz + beta * before[index].xyz;
        var ap = absorption(rho) * p;
        for (var face = 0u; face < 6u; face++) {
            let axis = face / 2u;
            let side = face & 1u;
            let h = params.cell[axis];
            if (is_outer(cell, axis, side)) {
                ap += outer_flux(d, p, vec3f(0.0), h) / h;
            } else {
                let other = beside(index, axis, side);
                let step = p - (z[other].xyz + beta * before[other].xyz);
                ap += inner_flux(d, diffusivity(density[other]), step, vec3f(0.0), h) / h;
            }
        }
        search[index] = vec4f(p, 0.0);
        product[index] = vec4f(ap, 0.0);
        product_sum = p * ap;
    }
    leave_sum(SEARCHED, group.x, lane, product_sum);
}
