"""From reduced images of media to the full image, and the surfaces behind them.

upsample, guided   a reduced image at full size, by depth or by density
transmittance      of homogeneous media, exact
compose            surfaces times transmittance
finish             all three in one pass, where no density grid needs more
"""
