// A cell's two bands as they are stored between steps: whole floats. See lpv.storage.

alias State = vec4f;

fn unpacked(v: State) -> vec4f {
    return v;
}

fn packed(v: vec4f) -> State {
    return v;
}
