// A cell's two bands as they are stored between steps: half floats. See lpv.storage.

alias State = vec2u;

fn unpacked(v: State) -> vec4f {
    return vec4f(unpack2x16float(v.x), unpack2x16float(v.y));
}

fn packed(v: vec4f) -> State {
    return vec2u(pack2x16float(v.xy), pack2x16float(v.zw));
}
