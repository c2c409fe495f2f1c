"""Cases on logs of real robots, whose truth is known: model or metadata are declared wrongly."""
