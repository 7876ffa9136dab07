"""Many problems at once, and one problem in many ways, on one machine or several.

`solve_many` and `race` hand tasks to an executor: this process, processes beside it, or a Ray
cluster. Whichever it is, a task has the same result, and ends with exactly one record.
"""
