"""Steps and plans given as text: applying them one by one, and checking what others planned.

values     what is written to values of CDL's types
calls      `r_clear(b, y=c)` to a behavior with values
simulate   behaviors applied one after another
reading    plans in text, JSON or PDDL
traces     the trace that a plan in JSON carries
validate   plans applied and replayed
"""
