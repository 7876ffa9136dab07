"""What a program means: the Hoare model, analyses and texts of the typed program."""
