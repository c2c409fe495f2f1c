"""Policies as files: how a training writes one, and how another one starts from it."""
