// The search direction p = z + beta p and A p; sums p.Ap.
//! use medium_grid
//! use partial_sums

// The search direction in a cell. In the first step `before` belongs to another solve.
fn search_direction(index: u32, beta: vec3f) -> vec3f {
    return z[index].xyz + select(beta * before[index].xyz, vec3f(0.0), iteration.step == 0u);
}

// The part of A p that the neighbours along one axis contribute; links are 0 across the border.
fn neighbours(index: u32, section: u32, stride: u32, is_low: bool, beta: vec3f) -> vec3f {
    let first = section * params.cells;
    let up = min(index + stride, params.cells - 1u);
    let down = select(index - stride, index, is_low);
    let link_down = select(links[first + down].xyz, vec3f(0.0), is_low);
    return links[first + index].xyz * search_direction(up, beta) + link_down * search_direction(down, beta);
}

@compute @workgroup_size(WX, WY, WZ) fn main(
    @builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    // beta = r.z of this step over that of the last one.
    let now = whole_sum(RZ + (iteration.step & 1u), lane);
    let last = whole_sum(RZ + (~iteration.step & 1u), lane);
    let beta = select(quotient(now, last), vec3f(0.0), iteration.step == 0u);
    // A p: the diagonal less the links to six neighbours.
    var product_sum = vec3f(0.0);
    if (id.x < params.cells) {
        let index = id.x;
        let cell = cell_of(index);
        let n = params.count;
        let p = search_direction(index, beta);
        let ap = links[index].xyz * p - neighbours(index, 1u, 1u, cell.x == 0u, beta)
            - neighbours(index, 2u, n.x, cell.y == 0u, beta)
            - neighbours(index, 3u, n.x * n.y, cell.z == 0u, beta);
        search[index] = vec4f(p, 0.0);
        product[index] = vec4f(ap, 0.0);
        product_sum = p * ap;
    }
    leave_sum(SEARCHED, group.x, lane, product_sum);
}
