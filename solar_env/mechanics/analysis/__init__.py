"""What can be said of a mechanism without running it: equilibrium, natural frequencies, shapes of its bodies.

The room may import every other room of `mechanics`; none imports it.
"""
