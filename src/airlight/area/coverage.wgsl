// The light of a pixel with glowing polygons by the exact part of it that they cover, in place of what one sample hit.
//! use pixel_point

const MOST_CORNERS = 12u;
const OWN_PLANE = 1e-3;     // of a polygon's radius
const ON_EDGE = 0.02;       // px
const SAME_GLOW = 0.01;     // of it: G-buffers round it

// What part of the box 0..1, 0..1 lies between an edge and x = 0, signed by its direction: around a polygon these sum
// up to the part that lies within it.
fn edge_cover(a: vec2f, b: vec2f) -> f32 {
    let rise = b.y - a.y;
    let low = saturate(a.y);
    let high = saturate(b.y);
    if (low == high) {
        return 0.0;
    }
    let slope = (b.x - a.x) / rise;
    let x = vec2f(a.x + (low - a.y) * slope, a.x + (high - a.y) * slope);
    // The mean of x, held between 0 and 1, along the edge: its integral over its range.
    let within = saturate(x);
    let integral = 0.5 * within * within + max(x - 1.0, vec2f(0.0));
    let wide = x.y - x.x;
    let steep = 0.5 * (within.x + within.y);
    let mean = select((integral.y - integral.x) / wide, steep, abs(wide) < 1e-3);
    return (high - low) * mean;
}

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let glow = textureLoad(emission, pixel, 0);
    let d = textureLoad(depth, pixel, 0);
    let p = pixel_point(position.xy, d);
    // The sample within the pixel as it is without jitter.
    let own = position.xy - params.jitter - floor(position.xy);
    // Each polygon is added by its cover, whatever the sample hit.
    var added = vec3f(0.0);
    var is_drawn = false;
    for (var i = 0u; i < params.count; i++) {
        let o = outlines[i];
        let first = i * MOST_CORNERS;
        let origin = vec4f(floor(position.xy), 0.0, 0.0);
        // Edge by edge: the cover, whether the sample lies within, and which point of the outline is nearest to it.
        var a = corners[first + o.corner_count - 1u] - origin;
        var cover = 0.0;
        var inside = vec2f(1e30, -1e30);
        var nearest = vec2f(1e30, 0.0);     // of its edges: the square of the distance, and the depth there
        for (var k = 0u; k < o.corner_count; k++) {
            let b = corners[first + k] - origin;
            cover += edge_cover(a.xy, b.xy);
            let side = b.xy - a.xy;
            let squared = max(dot(side, side), 1e-20);
            let off = (side.x * (own.y - a.y) - side.y * (own.x - a.x)) * inverseSqrt(squared);
            inside = vec2f(min(inside.x, off), max(inside.y, off));
            let along = saturate(dot(own - a.xy, side) / squared);
            let away = own - a.xy - along * side;
            if (dot(away, away) < nearest.x) {
                nearest = vec2f(dot(away, away), mix(a.z, b.z, along));
            }
            a = b;
        }
        // What lies before its plane hides it; beside it, what lies before the nearest point of its edge.
        let is_within = inside.x > -ON_EDGE || inside.y < ON_EDGE;
        let height = select(-1e30, dot(p - o.centre, o.normal), d > 0.0);
        let is_hidden = height > OWN_PLANE * o.radius && (is_within || d > nearest.y);
        added += select(abs(cover), 0.0, is_hidden) * o.radiance;
        // A sample that hit the polygon has shown it already.
        let is_glow = all(abs(glow.rgb - o.radiance) <= SAME_GLOW * o.radiance + vec3f(1e-6));
        is_drawn = is_drawn || (is_within && is_glow && abs(height) <= OWN_PLANE * o.radius);
    }
    return vec4f(select(glow.rgb, vec3f(0.0), is_drawn) + added, glow.a);
}
