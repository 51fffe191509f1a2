// Pixels that no gather point is like, and what lights them: the twin of maths/gather_orphans.py, which says where the
// numbers come from.
//! use gather

const KIN_POWER = 2.0;
const KIN_REACH = 0.5;

fn kinship(normal: vec3f, its_normal: vec3f, offset: vec3f, squares: vec3f, products: vec3f) -> f32 {
    let near = exp(-approach(offset, squares, products) / (KIN_REACH * KIN_REACH));
    return pow(saturate(dot(normal, its_normal)), KIN_POWER) * near;
}

fn listed_before(index: u32, count: u32, most: u32, phase: u32) -> u32 {
    return select(index, (index * most + phase) / max(count, 1u), count > most);
}
