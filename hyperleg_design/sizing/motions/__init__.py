"""Reference motions, planned from a model for any design: none was measured."""
