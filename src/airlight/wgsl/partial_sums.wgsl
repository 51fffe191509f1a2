// Dot products over all cells, a partial sum per workgroup. The including pass binds `params`
// (MediumParams), `sums` (array<vec4f>, sections of params.groups) and has 256 invocations a group.

const RZ = 0u;          // r.z of even steps; of odd ones in section 1
const SEARCHED = 2u;    // p.Ap
const ROW = 16u;        // 256 = ROW^2 values are added up in two rounds: barriers cost

var<workgroup> sum_own: array<vec3f, 256>;
var<workgroup> sum_rows: array<vec3f, ROW>;

// The sum of everybody's `value`, the same bits for all invocations.
fn group_sum(lane: u32, value: vec3f) -> vec3f {
    sum_own[lane] = value;
    workgroupBarrier();
    // Rows first, then rows of rows: always in the same order.
    if (lane < ROW) {
        var row = vec3f(0.0);
        for (var i = 0u; i < ROW; i++) {
            row += sum_own[ROW * lane + i];
        }
        sum_rows[lane] = row;
    }
    workgroupBarrier();
    var total = vec3f(0.0);
    for (var i = 0u; i < ROW; i++) {
        total += sum_rows[i];
    }
    return total;
}

// Leave this workgroup's sum of `value` in a section.
fn leave_sum(section: u32, group: u32, lane: u32, value: vec3f) {
    let total = group_sum(lane, value);
    if (lane == 0u) {
        sums[section * params.groups + group] = vec4f(total, 0.0);
    }
}

// All partial sums of a section, added up the same way in every workgroup.
fn whole_sum(section: u32, lane: u32) -> vec3f {
    var own = vec3f(0.0);
    for (var i = lane; i < params.groups; i += WX) {
        own += sums[section * params.groups + i].xyz;
    }
    let total = group_sum(lane, own);
    workgroupBarrier();
    return total;
}

// a/b, 0 where b is 0: a channel without light stays 0.
fn quotient(a: vec3f, b: vec3f) -> vec3f {
    let positive = b > vec3f(0.0);
    return select(vec3f(0.0), a / select(vec3f(1.0), b, positive), positive);
}
