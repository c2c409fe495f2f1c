"""Tools that a diagnosis is compared with, on the same logs: each fits a fixed set of parameters
that a person chose.
"""
