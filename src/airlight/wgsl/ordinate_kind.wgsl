// What the light of an ordinate comes from, its position.w (twin: Kind in pop/light/table.py).
const DISTANT = 0.0;        // directional lights and the environment
const LOCAL = 1.0;          // point and spot lights
const VIRTUAL = 2.0;        // a virtual point light
const BLOCK = 3.0;          // a block of another medium
const VIRTUAL_GRID = 4.0;   // a virtual point light that propagates in a grid of its own
