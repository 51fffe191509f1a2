// Adds a state to the total; or, at the end, the tail: what all later steps would add (lpv.sums).
//! needs fn unpacked(v: State) -> vec4f

override IS_SCALED: bool = false;   // the state is in stored units, the total is not
override PER_INVOCATION: u32 = 1;   // values that it adds

const LARGEST_RATIO = 0.97;

// What all blocks after the last would add, per unit of it: a geometric series of the ratio of the last two.
fn tail(channel: u32) -> f32 {
    let ratio = clamp(powers[1][channel] / max(powers[0][channel], 1e-30), 0.0, LARGEST_RATIO);
    return ratio / (1.0 - ratio);
}

@compute @workgroup_size(WX, WY, WZ) fn main(
    @builtin(local_invocation_index) own: u32, @builtin(workgroup_id) group: vec3u,
) {
    let first = group.x * WX * PER_INVOCATION + own;
    let end = min(params.values, (group.x + 1u) * WX * PER_INVOCATION);
    // A state of the sum, or the last block times what all blocks after it would add.
    var scale = 1.0;
    if (IS_SCALED) {
        scale = 1.0 / range[0];
    }
    for (var at = first; at < end; at += WX) {
        var gain = scale;
        if (params.is_tail != 0u) {
            gain *= tail(at / (params.values / 3u));
        }
        total[at] = select(total[at], vec4f(0.0), params.is_first != 0u) + gain * unpacked(state[at]);
    }
}
