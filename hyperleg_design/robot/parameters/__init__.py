"""Typed parameters of designs: fields with units and bounds, their values, and sections of them."""
