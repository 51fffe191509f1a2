"""Virtual point lights: what surfaces reflect into a medium once (Elek2014 section 6).

maps: reflective shadow maps, attenuated by media; reflected: where they are sampled
  -> lights: texels sampled by importance, written as ordinates of the medium
  -> grids: a grid of shells around each, where they propagate from cell to cell
"""
