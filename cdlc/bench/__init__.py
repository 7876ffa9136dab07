"""Many problems of files: which there are, how they are solved, and what came of it.

suite     folders, globs, problem files and TOML files to runs
loading   a run to a task for `crow.solve_many`
results   the file that records are appended to, and read from
running   runs to records, and on from where a run stopped
tables    records to tables, series to be drawn, and text
page      the same as one page of HTML
errors    what is wrong with suites and files of results
"""
