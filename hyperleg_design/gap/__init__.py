"""Where hardware and simulation differ, which unmodelled effect is the cause, and how far the gap
shrinks once it is added.
"""
