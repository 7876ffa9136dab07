"""The Hoare model with where each part of it comes from: `compile --emit hoare --explain`."""

from collections.abc import Iterator, Mapping

from cdlc import render
from cdlc.ir.text import LIMITED, Line, effects, names_of, preconditions, typed
from cdlc.ir.updates import MAX_SOURCES
from cdlc.source import SourceFile
from crow.program.triples import Triple


def explanation(triples: tuple[Triple, ...], sources: Mapping[str, SourceFile]) -> str:
    """Every triple with the statements behind each conjunct and update, shown in their sources.

    None of them may be `oversized`.
    """
    return "\n".join("\n".join(_triple(triple, sources)) + "\n" for triple in triples)


def _triple(triple: Triple, sources: Mapping[str, SourceFile]) -> Iterator[str]:
    place = "" if triple.location is None else f"   {triple.location}"
    yield f"{triple.behavior} ({typed(triple.parameters, names_of(triple))}){place}"
    for title, lines in (("needs", preconditions(triple)), ("changes", effects(triple))):
        yield f"  {title}{'' if lines else ' nothing'}"
        for line in lines:
            yield from (f"    {text}".rstrip() for text in _line(line, sources))


def _line(line: Line, sources: Mapping[str, SourceFile]) -> Iterator[str]:
    if line.is_limited:
        yield f"; {LIMITED}"
    yield line.text
    yield from render.excerpts(line.sources[:MAX_SOURCES], sources)
    if len(line.sources) > MAX_SOURCES:
        yield "… and other statements"
