// What an ordinate's light comes from, its position.w; pop.ordinates has the same.
const FROM_AFAR = 0.0;
const FROM_LAMP = 1.0;
const FROM_SURFACE = 2.0;   // a virtual light
const FROM_MEDIUM = 3.0;    // a block of another volume
const HOPS_ON = 4.0;        // a virtual light in a grid of its own
