//! use medium_grid
//! use partial_sums

// In the first step `before` is of another solve.
fn searched(index: u32, beta: vec3f) -> vec3f {
    return z[index].xyz + select(beta * before[index].xyz, vec3f(0.0), iteration.step == 0u);
}

// What the neighbours above and below along one axis take off A p; links are 0 across the border.
fn neighbours(index: u32, section: u32, stride: u32, is_low: bool, beta: vec3f) -> vec3f {
    let first = section * params.cells;
    let up = min(index + stride, params.cells - 1u);
    let down = select(index - stride, index, is_low);
    let link_down = select(links[first + down].xyz, vec3f(0.0), is_low);
    return links[first + index].xyz * searched(up, beta) + link_down * searched(down, beta);
}

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
        let n = params.count;
        let p = searched(index, beta);
        let ap = links[index].xyz * p - neighbours(index, 1u, 1u, cell.x == 0u, beta)
            - neighbours(index, 2u, n.x, cell.y == 0u, beta)
            - neighbours(index, 3u, n.x * n.y, cell.z == 0u, beta);
        search[index] = vec4f(p, 0.0);
        product[index] = vec4f(ap, 0.0);
        product_sum = p * ap;
    }
    leave_sum(SEARCHED, group.x, lane, product_sum);
}
