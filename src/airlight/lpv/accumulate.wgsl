override IS_SCALED: bool = false;   // the state is in stored units, the total is not

const LARGEST_RATIO = 0.97;

// What all blocks after the last would add, per unit of it: powers of one ratio.
fn tail(channel: u32) -> f32 {
    let ratio = clamp(powers[1][channel] / max(powers[0][channel], 1e-30), 0.0, LARGEST_RATIO);
    return ratio / (1.0 - ratio);
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.values) {
        return;
    }
    var gain = 1.0;
    if (params.is_tail != 0u) {
        gain = tail(id.x / (params.values / 3u));
    }
    if (IS_SCALED) {
        gain /= range[0];
    }
    total[id.x] = added(total[id.x], gain * unpacked(state[id.x]));
}
