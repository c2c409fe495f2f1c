"""From logs to residuals: smoothing, filtering, base motion, contact and residual channels."""
