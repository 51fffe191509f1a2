//! use tone

override is_encoding: bool = false;

const GROUND = vec3f(0.067, 0.071, 0.078);    // beside the image
const LINE = vec3f(0.94, 0.94, 0.94);         // between two images

@fragment fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let within = at.xy - params.corner;
    let uv = within / params.extent;
    let split = floor(params.split * params.extent.x);

    // Left of the line the one image, right of it the other.
    let one = textureSampleLevel(shown, linear_clamp, uv, 0.0).rgb;
    let other = textureSampleLevel(compared, linear_clamp, uv, 0.0).rgb;
    var c = select(one, other, within.x > split);
    c = select(c, LINE, params.split < 1.0 && abs(within.x - split) < 1.0);
    c = select(c, GROUND, any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)));
    return vec4f(select(c, srgb_decode(c), is_encoding), 1.0);
}
