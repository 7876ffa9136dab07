"""The uses of untyped parameters in a definition: places where a type is implied."""

from collections.abc import Sequence

from cdlc.frontend import syntax
from cdlc.frontend.demands import Demands, Hint, Known, Names, Slot
from cdlc.frontend.scope import (
    BUILTIN_FUNCTIONS,
    MAX_DEPTH,
    Context,
)
from crow.program import BOOL, FLOAT64, INT64, STRING, UNKNOWN, Type
from crow.program.types import (
    VectorType,
    is_number,
    underlying,
    wider_number,
)


class Uses:
    """Walks one definition and notes what each use of an untyped parameter implies."""

    def __init__(self, demands: Demands, context: Context) -> None:
        self.demands = demands
        self.declared = context.declarations
        self.owner = ""
        self.depth = 0

    def definition(self, node: syntax.Procedure) -> None:
        """Note the uses in all sections; `eff` sees the variables of `body`."""
        self.owner = node.name.text
        signature = self.declared.signature(self.owner)
        assert signature is not None
        names: Names = {}
        for index, parameter in enumerate(signature.parameters):
            slot = Slot(self.owner, index)
            names[parameter.name] = slot if slot in self.demands.slots else parameter.type
        after = names
        for section in node.sections:
            match section:
                case syntax.Goal(condition=condition, equals=None):
                    self.condition(condition, names)
                case syntax.Goal(condition=left, equals=right) if right is not None:
                    self._alike((left, right), names)
                case syntax.Body(statements=statements):
                    after = self._block(statements, names)
                case _:
                    pass
        for section in node.sections:
            if isinstance(section, syntax.Effect):
                self._block(section.statements, after)
            elif isinstance(section, syntax.ErrorStatement):
                self.demands.broken.add(self.owner)

    def condition(self, node: syntax.Expression, names: Names) -> None:
        """Note the uses in an expression that is true or false."""
        self._visit(node, names)
        self._impose(node, BOOL, names)

    # ---------------------------------------------------------------------------- statements

    def _block(self, statements: Sequence[syntax.Statement], names: Names) -> Names:
        for statement in statements:
            names = self._statement(statement, names)
        return names

    def _statement(self, node: syntax.Statement, names: Names) -> Names:
        match node:
            case syntax.Let(name=name, type=written, value=value):
                known = self._visit(value, names)
                if written is not None:
                    known = self._written(written)
                    self._impose(value, known, names)
                return {**names, name.text: known}
            case syntax.Bind():
                return self._bind(node, names)
            case syntax.Assert(condition=condition) | syntax.Achieve(condition=condition):
                self.condition(condition, names)
            case syntax.CallStatement(call=call):
                self._arguments(call, self._command(call.name.text), names)
            case syntax.Assignment(target=target, value=value):
                known = self._visit(target, names)
                self._visit(value, names)
                self._impose(value, known, names)
            case syntax.Return(value=value):
                self._visit(value, names)
            case syntax.Group(body=body):
                self._block(body, names)
            case syntax.Promotable(body=body):
                # What M introduces is an error there, and still visible after it.
                return self._block(body, names)
            case syntax.ForEach(variables=variables, body=body):
                self._block(body, {**names, **self._variables(variables)})
            case syntax.ForRange(variable=variable, arguments=arguments, body=body):
                for argument in arguments:
                    self._visit(argument, names)
                self._block(body, {**names, variable.text: INT64})
            case syntax.If(branches=branches, otherwise=otherwise):
                for condition, then in branches:
                    self.condition(condition, names)
                    self._block(then, names)
                self._block(otherwise or (), names)
            case syntax.ErrorStatement():
                self.demands.broken.add(self.owner)
            case syntax.Word():
                pass
        return names

    def _bind(self, node: syntax.Bind, names: Names) -> Names:
        names = {**names, **self._variables(node.variables)}
        if node.condition is not None:
            self._visit(node.condition, names)
        return names

    def _variables(self, written: tuple[syntax.TypedName, ...]) -> Names:
        """The variables with their types; in `x, y: T` both have type `T`."""
        names: Names = {}
        last: Known = None
        for item in reversed(written):
            if item.type is not None:
                last = self._written(item.type)
            names[item.name.text] = last
        return names

    def _written(self, written: syntax.Type) -> Type:
        match written:
            case syntax.NamedType(name=name):
                return self.declared.types.get(name, UNKNOWN)
            case syntax.VectorType(element=element, length=length):
                return VectorType(self._written(element), length)
            case syntax.ListType():
                return UNKNOWN

    def _command(self, name: str) -> tuple[Known, ...] | None:
        """What a controller or behavior wants its arguments to be; None if there is none such."""
        controller = self.declared.controllers.get(name)
        if controller is not None:
            return tuple(p.type for p in controller.parameters)
        behavior = self.declared.behaviors.get(name)
        if behavior is None:
            return None
        slots = ((Slot(name, i), p.type) for i, p in enumerate(behavior.parameters))
        return tuple(slot if slot in self.demands.slots else type_ for slot, type_ in slots)

    # --------------------------------------------------------------------------- expressions

    def _arguments(self, call: syntax.Call, wanted: tuple[Known, ...] | None, names: Names) -> None:
        for index, argument in enumerate(call.arguments):
            self._visit(argument, names)
            known = wanted[index] if wanted is not None and index < len(wanted) else UNKNOWN
            self._impose(argument, known, names)

    def _alike(self, operands: Sequence[syntax.Expression], names: Names) -> Known:
        """Operands that are of one type, such as those of a comparison."""
        known = [self._visit(operand, names) for operand in operands]
        for operand in operands:
            for other in dict.fromkeys(known):
                self._impose(operand, other, names)
        return _joined(known)

    def _visit(self, node: syntax.Expression, names: Names) -> Known:
        """What an expression is; the uses inside it are noted on the way."""
        self.depth += 1
        try:
            # The check of the body reports such an expression.
            return UNKNOWN if self.depth > MAX_DEPTH else self._known(node, names)
        finally:
            self.depth -= 1

    def _known(self, node: syntax.Expression, names: Names) -> Known:
        match node:
            case syntax.NameExpression(name=name):
                return self._name(name, names)
            case syntax.Literal(value=value):
                return _literal(value)
            case syntax.Call():
                return self._call(node, names)
            case syntax.VectorLiteral(elements=elements):
                self._alike(elements, names)
                return None
            case syntax.Unary(operator="not", operand=operand):
                self.condition(operand, names)
                return BOOL
            case syntax.Unary(operand=operand):
                return self._visit(operand, names)
            case syntax.Connective(operands=operands):
                for operand in operands:
                    self.condition(operand, names)
                return BOOL
            case syntax.Binary(operator="^", left=left, right=right):
                self.condition(left, names)
                self.condition(right, names)
                return BOOL
            case syntax.Binary(operator=operator, left=left, right=right):
                return self._arithmetic(operator, left, right, names)
            case syntax.Comparison(operands=operands):
                self._alike(operands, names)
                return BOOL
            case syntax.Conditional(condition=condition, then=then, otherwise=otherwise):
                self.condition(condition, names)
                return self._alike((then, otherwise), names)
            case syntax.Quantified(variables=variables, where=where, body=body):
                inner = {**names, **self._variables(variables)}
                for part in (where, body):
                    if part is not None:
                        self.condition(part, inner)
                return BOOL
            case syntax.ErrorExpression():
                self.demands.broken.add(self.owner)
                return UNKNOWN
            case syntax.Ellipsis_():
                return UNKNOWN

    def _name(self, name: str, names: Names) -> Known:
        if name in names:
            return names[name]
        known = self.declared.objects.get(name) or self.declared.features.get(name)
        return UNKNOWN if known is None else known.type

    def _call(self, node: syntax.Call, names: Names) -> Known:
        name = node.name.text
        if name in BUILTIN_FUNCTIONS:
            return self._alike(node.arguments, names)
        called = self.declared.features.get(name) or self.declared.functions.get(name)
        wanted = None if called is None else tuple(p.type for p in called.parameters)
        self._arguments(node, wanted, names)
        return UNKNOWN if called is None else called.type

    def _arithmetic(
        self, operator: str, left: syntax.Expression, right: syntax.Expression, names: Names
    ) -> Known:
        if operator in ("+", "-"):
            return self._alike((left, right), names)
        # A vector may be scaled by a number, so that the sides need not be alike.
        known = [self._visit(left, names), self._visit(right, names)]
        for node, other in ((left, known[1]), (right, known[0])):
            type_ = other.type if isinstance(other, Hint) else other
            if not isinstance(type_, Slot) and type_ is not None and is_number(type_):
                self._impose(node, other, names)
        return _joined(known)

    def _impose(self, node: syntax.Expression, known: Known, names: Names) -> None:
        """Note that an expression stands where `known` is wanted."""
        self.depth += 1
        if self.depth <= MAX_DEPTH and known is not None:
            self._pass_on(node, known, names)
        self.depth -= 1

    def _pass_on(self, node: syntax.Expression, known: Known, names: Names) -> None:
        match node:
            case syntax.NameExpression(name=name):
                slot = names.get(name)
                if isinstance(slot, Slot):
                    self.demands.add(slot, known)
            case syntax.Unary(operator="-", operand=operand):
                self._impose(operand, known, names)
            case syntax.Conditional(then=then, otherwise=otherwise):
                self._impose(then, known, names)
                self._impose(otherwise, known, names)
            case syntax.Binary(operator="+" | "-", left=left, right=right):
                self._impose(left, known, names)
                self._impose(right, known, names)
            case syntax.Binary(operator="*" | "/" | "//" | "%" | "**", left=left, right=right):
                if not isinstance(known, Slot | Hint) and known is not None and is_number(known):
                    self._impose(left, known, names)
                    self._impose(right, known, names)
            case syntax.VectorLiteral(elements=elements):
                base = None if isinstance(known, Slot | Hint | None) else underlying(known)
                if isinstance(base, VectorType):
                    for element in elements:
                        self._impose(element, base.element, names)
            case _:
                return


def _literal(value: bool | int | float | str) -> Known:
    match value:
        case bool():
            return BOOL
        case int():
            return Hint(INT64)
        case float():
            return Hint(FLOAT64)
        case str():
            return STRING


def _joined(known: Sequence[Known]) -> Known:
    """What operands have in common: a type before a parameter before a literal."""
    types = [k for k in known if k is not None and not isinstance(k, Slot | Hint)]
    if types:
        numbers = all(is_number(t) for t in types) and len(set(types)) > 1
        return wider_number(*types[:2]) if numbers else types[0]
    slots = [k for k in known if isinstance(k, Slot)]
    hints = [k for k in known if isinstance(k, Hint)]
    if slots:
        return slots[0]
    return min(hints, key=lambda h: str(h.type)) if hints else None
