"""Single scattering with volumetric shadows: radiance of lights that media scatter once to the eye.

shadow maps -> bounds: hierarchy of nearest and farthest depths -> shafts: lit intervals
shadow maps -> facets: quad-tree of planes, triangles -> shadow_volumes: rasterised, summed
shadow maps -> jitter: samples along the ray -> blur
image: which of these an image takes; shadow_rays: what their passes bind
"""
