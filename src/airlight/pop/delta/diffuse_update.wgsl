// A step along the search direction: phi += alpha p, r -= alpha A p, z = r/diagonal; sums r.z.
//! use partial_sums

@compute @workgroup_size(WX, WY, WZ) fn main(
    @builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    // alpha = r.z over p.Ap.
    let now = whole_sum(RZ + (iteration.step & 1u), lane);
    let alpha = quotient(now, whole_sum(SEARCHED, lane));
    // The solution and its residual, and z for the next search direction.
    var rz = vec3f(0.0);
    if (id.x < params.cells) {
        let index = id.x;
        let r = residual[index].xyz - alpha * product[index].xyz;
        let scaled = r / links[index].xyz;
        phi[index] = vec4f(phi[index].xyz + alpha * search[index].xyz, 0.0);
        residual[index] = vec4f(r, 0.0);
        z[index] = vec4f(scaled, 0.0);
        rz = r * scaled;
    }
    leave_sum(RZ + (~iteration.step & 1u), group.x, lane, rz);
}
