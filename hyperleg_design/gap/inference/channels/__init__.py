"""The probabilistic model of one residual channel: discrepancy, scales, marginal likelihood."""
