"""A soak: `./run soak --help`. Whether memory stays flat over thousands of moving frames.

moving    a scene in which everything moves, as a function of the frame's number
levels    what is measured: memory of the process and of the device, wgpu's objects
phases    frames, renderers made and closed, resizes
"""
