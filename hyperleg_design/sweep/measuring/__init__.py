"""Sizing measures of designs: their register, one function each, and what they share."""
