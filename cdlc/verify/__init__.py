"""Proves what behaviors claim, or refutes it with a state in which it fails (lowering.md §1).

    question    what is asked about a triple, over formulas of the Hoare model
    ways        the bodies of a behavior that leave no choice, one for each triple
    situation   a concrete case, tried out by the interpreter
    smt         formulas in z3, and its answers
    checks      goal, applicable, guards, writes: questions to verdicts
    same        behaviors that are the same transition
    explain     counterexamples made small and put into words
    results     verdicts and their JSON; `text` shows them
    run         the checks of a whole program

Nothing here imports z3 before `run.verify` does.
"""
