"""Every syntax tree, printed and parsed, is itself again."""

from hypothesis import HealthCheck, given, settings
from layout_mutations import nodes, read
from strategies import modules

from cdlc.diagnostics import Collector
from cdlc.frontend import syntax
from cdlc.frontend.formatter import format_module, format_source
from cdlc.source import SourceFile

patient = settings(
    max_examples=settings().max_examples * 3 // 5,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)

NEVER_PRINTED = {syntax.Node, syntax.Annotated, syntax.ErrorExpression, syntax.ErrorStatement}


@patient
@given(modules)
def test_printed_tree_parses_to_itself_and_is_in_canonical_layout(module: syntax.Module) -> None:
    text = format_module(module)
    assert read(text) == module, text
    assert format_source(SourceFile("random.cdl", text), Collector()) == text


def test_random_trees_have_every_node() -> None:
    seen: set[type] = set()

    @settings(parent=patient, database=None, max_examples=150, derandomize=True)
    @given(modules)
    def look(module: syntax.Module) -> None:
        seen.update(map(type, nodes(module)))

    look()
    assert seen == {
        kind
        for kind in vars(syntax).values()
        if isinstance(kind, type) and issubclass(kind, syntax.Node) and kind not in NEVER_PRINTED
    }
