"""Laws that a design names: friction and gears over motors and reductions."""
