// How far the light that a gather point had in the frames before stands for what it has now: the twin of
// maths/gather_history.py, which says where the numbers come from.

const BESIDE = 1e-3;
const SURE = 0.5;
const DEVIATIONS = 2.0;
const ALIKE = 0.02;
const CHANGING = 4.0;

fn texel_share(away: vec2f) -> f32 {
    let near = max(vec2f(1.0) - abs(away), vec2f(0.0));
    return near.x * near.y + BESIDE;
}

fn frames_kept(frames: f32, best: f32, most: f32) -> f32 {
    return min(frames * saturate(best / SURE), most);
}

fn noise_reach(mean: f32, variance: f32) -> f32 {
    return DEVIATIONS * sqrt(max(variance, 0.0)) + ALIKE * mean;
}

fn frames_believed(frames: f32, before: f32, mean: f32, variance: f32) -> f32 {
    let reach = noise_reach(mean, variance);
    let off = max(abs(before - mean) - reach, 0.0);
    return min(frames, CHANGING) * saturate(1.0 - off / max(reach, 1e-30));
}

fn followed(before: f32, mean: f32, variance: f32) -> f32 {
    let reach = noise_reach(mean, variance);
    return clamp(before, max(mean - reach, 0.0), mean + reach);
}
