"""The browser page of `hyperleg view`: robots in three dimensions, sliders, charts and walks."""
