"""The frozen benchmark: cases with known truth, rules of scoring, a runner and its table.

`scoring.VERSION` names the cases and the rules together; whoever changes either raises it.
"""
