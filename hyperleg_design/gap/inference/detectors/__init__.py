"""Causes that no residual shows: a constant error of the IMU, feet that slide or sink.

Each is measured by itself; `pipeline.detected_causes` puts it into the answer.
"""
