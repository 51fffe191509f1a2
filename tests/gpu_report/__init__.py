"""`./run gpu`: what a machine's graphics device does with the tests, both code paths and frames."""
