"""Robots of the blind trial as trees of hinges, apart from the models that the diagnosis reads."""
