// How much light a material reflects over all directions, by mesh coordinates. The including pass binds
// `albedo_rows` and `albedo_texels`, as gather/albedo.py lays them out.

const MOST_GRAZING = 0.0625;
const BLACK_BACK = 16u;

fn wrapped(u: f32, wrap: u32) -> f32 {
    let mirrored = abs(u - 2.0 * floor(u * 0.5 + 0.5));
    let repeated = select(fract(u), mirrored, wrap == 1u);
    return select(repeated, clamp(u, 0.0, 1.0), wrap == 2u);
}

// rgb towards lights; a what light from all around adds, as it grazes.
fn hit_albedo(material: u32, uv: vec2f, is_behind: bool) -> vec4f {
    let row = albedo_rows[material];
    let share = select(1.0, 0.0, is_behind && (row.wrap & BLACK_BACK) != 0u);
    let at = uv * row.uv_transform.xy + row.uv_transform.zw;
    let place = vec2f(wrapped(at.x, row.wrap & 3u), wrapped(at.y, (row.wrap >> 2u) & 3u));
    let size = vec2u(row.width, row.height);
    let texel = min(vec2u(place * vec2f(size)), size - 1u);
    let value = unpack4x8unorm(albedo_texels[row.first + texel.y * size.x + texel.x]);
    return share * vec4f(value.rgb * value.rgb, value.a * MOST_GRAZING);
}
