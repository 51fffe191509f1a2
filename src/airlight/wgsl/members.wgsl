// Whether medium m is one of those whose bits are set, 128 each in `low` and `high`; see media/media_rows.py.
fn is_member(m: u32, low: vec4u, high: vec4u) -> bool {
    let words = select(high, low, m < 128u);
    return ((words[(m >> 5u) & 3u] >> (m & 31u)) & 1u) == 1u;
}
