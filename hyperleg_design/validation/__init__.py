"""How right the diagnosis is: a frozen benchmark of real logs, other people's robots and blind
plants.
"""
