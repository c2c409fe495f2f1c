"""Causes that no residual shows: feet that slide or sink.

Each is measured by itself; `pipeline.detected_causes` puts it into the answer.
"""
