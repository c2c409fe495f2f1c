"""What the protocols run: straight walks, the T-test and its course."""
