"""What a training writes down of itself: checkpoints, measures, progress and short trials."""
