// What a hit's place carries beside it: which material was met, and from which side. Above 0 for every hit.

fn hit_code(material: u32, is_behind: bool) -> f32 {
    return f32(2u * material + 1u + u32(is_behind));
}

fn hit_material(code: f32) -> u32 {
    return (u32(code) - 1u) / 2u;
}

fn is_hit_behind(code: f32) -> bool {
    return (u32(code) - 1u) % 2u == 1u;
}
