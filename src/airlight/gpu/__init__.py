"""The device and how to talk to it; the only importer of wgpu.

device (asked, code_paths)   which adapter, its limits and features, the paths that suit it
scope, memory                who releases what; textures and buffers
shared, uploads              what parts of a technique have in common; what all renderers have
layout, slots, source        structs declared once, bindings, WGSL files and `//! use`
rows                         tables of structs in textures, read in no order
   -> compute, raster        passes: one class beside its WGSL; bindings, pipelines: cached
   -> fullscreen, stored     passes over whole images, drawn or, on GPUs, computed and stored
   -> commands, recorded     what a frame encodes; what stays the same is replayed
failures, demands            what the device refuses, with pass, limit and remedy
process                      which process may use it
lifetime                     from opening to closing, by one thread, whole again after an error
canvas                       a window, or a browser's image, to draw into
sliced, bands, tally         commands in the background, long passes in bands; counted
counted                      passes over rows of which the device knows how many there are
quick_types                  C types of wgpu-py, declared sooner
interpolants, lanes          flat interpolants and lanes of vectors, on CPU adapters
"""
