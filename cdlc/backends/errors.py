"""Every message of the backends. The docstring of a kind is its page."""

from dataclasses import dataclass

from cdlc.diagnostics import Diagnostic


@dataclass(frozen=True, kw_only=True)
class NoInitialValue(Diagnostic):
    """An `init` that cannot be computed: an unset value is read, or a number does not fit.

    init:
      size[A] = size[B] / count
    """

    reason: str

    def message(self) -> str:
        return f"the initial state cannot be computed: {self.reason}"
