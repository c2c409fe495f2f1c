"""Samples, nuisance parameters, noise model, linearisation, fits and the choice of causes."""
