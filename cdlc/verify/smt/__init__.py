"""Formulas in z3, and its answers; every module here imports z3, so nobody imports them early.

arithmetic  CDL's numbers: `//` and `%` as in Python, ranges
universe    which objects there are: a few, each by name, or any number
encode      pooled formulas to z3 terms, each node once
solver      a question to z3 with a time limit, in a thread that can be interrupted
model       z3's answer as a state, arguments and tables of external functions
"""
