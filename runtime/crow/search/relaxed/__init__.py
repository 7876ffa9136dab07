"""The delete relaxation of what is left to do: what it would cost if nothing true became false."""
