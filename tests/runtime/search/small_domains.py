"""Domains that several tests of searches plan in."""

COMMITTED = """
behavior m():
  goal: r()
  body:
    bind x: T
    do c(x)
    commit
    assert q(x)
    do d()
  eff:
    r[...] = True
"""
