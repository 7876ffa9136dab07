"""Problems from texts."""

from pathlib import Path
from tempfile import TemporaryDirectory

import cdlc
import crow


def from_texts(domain: str, problem: str) -> crow.Problem:
    """The problem of two CDL texts. Raises cdlc.CompileError."""
    with TemporaryDirectory() as folder:
        files = Path(folder) / "domain.cdl", Path(folder) / "problem.cdl"
        for file, text in zip(files, (domain, problem), strict=True):
            file.write_text(text, "utf-8")
        return cdlc.compile(*files).task()
