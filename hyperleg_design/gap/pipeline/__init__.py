"""From logs to a diagnosis: `diagnose` calls checks, signals and inference in turn, `answer` makes
the answer of their result, and `detected_causes` adds what no residual shows.
"""
