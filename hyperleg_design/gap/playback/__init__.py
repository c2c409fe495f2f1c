"""Replays of logs, measures of how well they agree, overlays and what they change."""
