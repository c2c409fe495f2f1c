"""The designs that a sweep covers: its axes, and the samples along them."""
