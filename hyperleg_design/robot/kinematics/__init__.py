"""The kinematic tree of a robot of any family: links, joints, postures, mass and height."""
