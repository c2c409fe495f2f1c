"""Fine-tunings of a policy to designs: finalists of a search, and held-out designs of a spread."""
