"""Trials of a sweep's designs: which policies run on them, and the trials that are shipped."""
