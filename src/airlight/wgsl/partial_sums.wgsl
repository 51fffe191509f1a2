// Dot products over all cells, a partial sum per workgroup. The including pass binds `params`
// (MediumParams), `sums` (array<vec4f>, sections of params.groups) and has WX invocations a group.

const RZ = 0u;          // r.z of even steps; of odd ones in section 1
const SEARCHED = 2u;    // p.Ap

var<workgroup> sum_tree: array<vec4f, WX>;

fn reduced(lane: u32) -> vec4f {
    for (var width = WX / 2u; width > 0u; width /= 2u) {
        workgroupBarrier();
        if (lane < width) {
            sum_tree[lane] += sum_tree[lane + width];
        }
    }
    workgroupBarrier();
    return sum_tree[0];
}

// Leave this workgroup's sum of `value` in a section.
fn leave_sum(section: u32, group: u32, lane: u32, value: vec3f) {
    sum_tree[lane] = vec4f(value, 0.0);
    let total = reduced(lane);
    if (lane == 0u) {
        sums[section * params.groups + group] = total;
    }
    workgroupBarrier();
}

// All partial sums of a section, added up the same way in every workgroup.
fn whole_sum(section: u32, lane: u32) -> vec3f {
    var own = vec4f(0.0);
    for (var i = lane; i < params.groups; i += WX) {
        own += sums[section * params.groups + i];
    }
    sum_tree[lane] = own;
    let total = reduced(lane);
    workgroupBarrier();
    return total.xyz;
}

// a/b, 0 where b is 0: a channel without light stays 0.
fn quotient(a: vec3f, b: vec3f) -> vec3f {
    let positive = b > vec3f(0.0);
    return select(vec3f(0.0), a / select(vec3f(1.0), b, positive), positive);
}
