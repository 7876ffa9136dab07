"""Steps and plans given as text: applying them one by one, and checking what others planned.

calls      `r_clear(b, y=c)` as text to a behavior with values
simulate   behaviors applied one after another
validate   plans in text, JSON or PDDL
traces     the trace that a plan in JSON carries
"""
