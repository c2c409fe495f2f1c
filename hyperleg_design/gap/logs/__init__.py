"""The log format, its metadata, how walks are recorded, and readers of other formats."""
