"""The scheme delta-beam: an attenuated beam per ordinate, and diffusion of what leaves the beams.

    ordinates, paths -> deposit: power that leaves all beams in every cell
      -> diffuse: fluence and flux of scattered light, one linear solve
      -> near_light: what both miss close to local lights
      -> outgoing: diffuse light that goes towards the eye, from every cell
      -> emission: radiance that every cell scatters towards the eye
      -> smooth: the same on cells half as wide, for marching
    border: diffuse light that enters a finer grid from the larger one around it

differs: Elek2014 propagates every ordinate from cell to cell; `grids` does.
"""
