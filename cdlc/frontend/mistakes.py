"""What to say of a token that does not fit, and how to read on as if it had been right."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from lark import Token

from cdlc.diagnostics import Collector, Help, Replacement, nearest
from cdlc.frontend import errors
from cdlc.frontend.build import token_span
from cdlc.frontend.layout import Line
from cdlc.source import SourceFile, Span

_HEADERS = ("typedef", "feature", "def", "controller", "behavior", "action", "generator",
            "include", "object_constant", "domain", "problem", "objects", "init", "goal",
            "minimize")  # fmt: skip
_SECTIONS = ("goal", "body", "eff", "in", "out")
HEADERS = frozenset(word.upper() for word in _HEADERS)
SECTIONS = frozenset(word.upper() for word in _SECTIONS)
STATEMENTS = frozenset(
    ("LET", "ASSERT", "ACHIEVE", "ACHIEVE_ONCE", "DO", "BIND", "COMMIT", "RETURN", "PASS", "BREAK",
     "CONTINUE", "IF", "ELIF", "ELSE", "FOR", "FOREACH", "FORALL", "PROMOTABLE", "SEQUENTIAL",
     "UNORDERED", "ALTERNATIVE", "NAME")
)  # fmt: skip

# What users of Python, PDDL and other languages write.
_OTHER_HEADERS = {
    "function": "def", "predicate": "feature", "fluent": "feature", "state": "feature",
    "class": "typedef", "type": "typedef", "rule": "behavior", "operator": "behavior",
    "skill": "controller", "command": "controller", "constant": "object_constant",
    "initial": "init", "metric": "minimize",
}  # fmt: skip
_OTHER_SECTIONS = {
    "effect": "eff", "effects": "eff", "post": "eff", "postcondition": "eff", "achieves": "goal",
    "plan": "body", "do": "body",
    "steps": "body", "input": "in", "inputs": "in", "output": "out", "outputs": "out",
}  # fmt: skip
_WITH_PARAMETERS = ("FEATURE", "CONTROLLER", "BEHAVIOR", "DEF")
_WITHOUT_VALUE = ("CONTROLLER", "BEHAVIOR", "ACTION", "GENERATOR")
_PRECONDITIONS = ("pre", "precondition", "preconditions", "requires", "condition")
_OTHER_WORDS = {
    "lambda": "name the function with `def f(x: T) -> T:` at the top level",
    "class": "`typedef T: object` defines a type",
    "from": '`include "file.cdl"` brings in definitions',
    "with": "there is no `with`; `sequential:` and `unordered:` group statements",
    "try": "a plan that fails is searched around; there is no `try`",
    "yield": "a `generator` names its results under `out:`",
    "del": "features are set to False: `f[x] = False`",
    "raise": "`assert` a condition that must hold",
    "is": "compare with `==`",
    "such": "the condition of a `bind` follows a colon: `bind x: T where: c`",
    "->": "`a -> b` is `not a or b`",
    "implies": "`a implies b` is `not a or b`",
    "xor": "exclusive or is `^`",
    "when": "use `if c:`",
    "then": "`if c:` opens a block, and `a if c else b` is an expression",
}
_QUOTATION_MARKS = (
    "\N{LEFT DOUBLE QUOTATION MARK}\N{RIGHT DOUBLE QUOTATION MARK}"
    "\N{DOUBLE LOW-9 QUOTATION MARK}\N{LEFT SINGLE QUOTATION MARK}\N{RIGHT SINGLE QUOTATION MARK}"
)
_SYMBOLS = {
    "\N{LESS-THAN OR EQUAL TO}": "<=",
    "\N{GREATER-THAN OR EQUAL TO}": ">=",
    "\N{NOT EQUAL TO}": "!=",
    "\N{LOGICAL AND}": "and",
    "\N{LOGICAL OR}": "or",
    "\N{NOT SIGN}": "not",
    "\N{FOR ALL}": "forall",
    "\N{THERE EXISTS}": "exists",
    "\N{RIGHTWARDS ARROW}": "->",
    "\N{MULTIPLICATION SIGN}": "*",
    "\N{MINUS SIGN}": "-",
}
_OPERATORS = {"&": "AND", "&&": "AND", "|": "OR", "||": "OR", "!": "NOT"}
_SPELLED = {
    "COLON": "`:`", "_NEWLINE": "the end of the line", "RPAR": "`)`", "RSQB": "`]`",
    "LPAR": "`(`", "STRING": "a string in double quotes", "COMMA": "`,`", "EQUAL": "`=`",
    "IN": "`in`", "ELSE": "`else`",
}  # fmt: skip


@dataclass(frozen=True)
class Unexpected:
    """A token of a stream that does not fit, and the kinds of token that would have."""

    source: SourceFile
    stream: list[tuple[Token, Line]]
    index: int
    accepted: frozenset[str]

    @property
    def token(self) -> Token:
        """The token."""
        return self.stream[self.index][0]

    @property
    def line(self) -> Line:
        """The line it stands on."""
        return self.stream[self.index][1]

    @property
    def is_first(self) -> bool:
        """Whether it starts its line."""
        return self.line.tokens[0] is self.token

    @cached_property
    def previous(self) -> Token:
        """The token before it on its line, or the token itself."""
        if self.index == 0 or self.is_first:
            return self.token
        return self.stream[self.index - 1][0]

    @cached_property
    def following(self) -> str:
        """The kind of the token after it, or nothing."""
        return self.stream[self.index + 1][0].type if self.index + 1 < len(self.stream) else ""

    @property
    def wants_header(self) -> bool:
        """Whether a definition may start here."""
        return {"TYPEDEF", "FEATURE"} <= self.accepted and "NAME" not in self.accepted

    @property
    def wants_section(self) -> bool:
        """Whether a section of a behavior may start here."""
        return {"GOAL", "BODY"} <= self.accepted and "NAME" not in self.accepted

    def diagnose(self, help_: Help | None = None) -> "errors.SyntaxError_":
        """The complaint about the token."""
        span = token_span(self.token)
        if not self.token and self.line.tokens:  # a mark of the layout
            span = Span(self.line.span.end, self.line.span.end)
        location = self.source.location(span)
        expected = _expected(self)
        return errors.SyntaxError_(
            location=location, found=_describe(self.token), expected=expected, hint=help_
        )

    def replace(self, text: str, why: str = "") -> Help:
        """A help that replaces the token."""
        location = self.source.location(token_span(self.token))
        return Help(why or f"did you mean `{text}`?", Replacement(location, text))


@dataclass(frozen=True, slots=True)
class Correction:
    """Tokens to read instead of `length` ones from `offset` relative to the wrong one."""

    diagnostic: "errors.SyntaxError_"
    tokens: tuple[Token, ...]
    offset: int = 0
    length: int = 1


# ------------------------------------------------------------------------------------ corrections


def correct(wrong: Unexpected) -> Correction | None:
    """What was meant, where that is plain enough to carry on as if it had been written."""
    token, accepted = wrong.token, wrong.accepted
    if not token:  # a mark of the layout, which stands in no line
        return None
    match token.type:
        case "EQUAL" if "EQUALS" in accepted:
            return _instead(wrong, "EQUALS", "==", "compare with `==`")
        case "EQUALS" if "EQUAL" in accepted:
            return _instead(wrong, "EQUAL", "=", "assign with `=`")
        case "COLON" if wrong.following == "EQUAL" and "EQUAL" in accepted:
            sign = Token("EQUAL", "=", start_pos=token.start_pos)
            return Correction(wrong.diagnose(Help("assign with `=`")), (sign,), length=2)
        case "FOREIGN" if _OPERATORS[token] in accepted:
            word = _OPERATORS[token].lower()
            return _instead(wrong, _OPERATORS[token], word, f"the operator is `{word}`")
        case "QUOTED" if "STRING" in accepted and '"' not in token and "\\" not in token:
            text = f'"{token[1:-1]}"'
            return _instead(wrong, "STRING", text, "strings are written with double quotes")
        case "UNCLOSED" if "STRING" in accepted:
            return _closed(wrong)
        case "IN" if "COLON" in accepted and wrong.line.tokens[0].type != "GENERATOR":
            return _instead(wrong, "COLON", ":", f"write `{_over_objects(wrong)}`")
        case "IF" if wrong.previous.type == "ELSE" and "COLON" in accepted:
            return _else_if(wrong)
        case "PROMOTABLE" if wrong.previous.type in ("SEQUENTIAL", "UNORDERED", "ALTERNATIVE"):
            hint = Help(f"write `promotable {wrong.previous}:`")
            return Correction(wrong.diagnose(hint), (token, wrong.previous), offset=-1, length=2)
        case _ if wrong.previous.type == "WHERE" and "COLON" in accepted:
            colon = Token("COLON", ":", start_pos=token.start_pos)
            return Correction(wrong.diagnose(Help("a colon follows `where`")), (colon, token))
        case "COLON" if accepted == {"IN"}:
            return _for_over_objects(wrong)
        case _ if wrong.is_first and token.isidentifier():
            return _header(wrong)
    return None


def _instead(wrong: Unexpected, kind: str, text: str, why: str = "") -> Correction:
    start, end = token_span(wrong.token)
    replacement = Token(kind, text, start_pos=start, end_pos=end)
    return Correction(wrong.diagnose(wrong.replace(text, why)), (replacement,))


def _closed(wrong: Unexpected) -> Correction:
    """An unclosed string, read as far as a colon or bracket that ends its line."""
    text = wrong.token.rstrip().rstrip(":)]")
    start = wrong.token.start_pos
    end = token_span(wrong.token).end
    string = Token("STRING", f'{text.rstrip(chr(92))}"', start_pos=start, end_pos=end)
    hint = Help("the string is not closed on its line")
    return Correction(wrong.diagnose(hint), (string,))


def _over_objects(wrong: Unexpected) -> str:
    word = wrong.line.tokens[0]
    quantifier = next((t for t, _ in reversed(wrong.stream[: wrong.index])
                       if t.type in ("FORALL", "EXISTS", "FOREACH")), word)  # fmt: skip
    return f"{quantifier if quantifier.type != 'FOR' else 'for each'} {wrong.previous}: T"


def _else_if(wrong: Unexpected) -> Correction:
    word = Token("ELIF", "elif", start_pos=wrong.previous.start_pos)
    hint = Help("`else if` is written `elif`")
    return Correction(wrong.diagnose(hint), (word,), offset=-1, length=2)


def _for_over_objects(wrong: Unexpected) -> Correction | None:
    """`for x: T:`, with the word that runs over objects."""
    first = wrong.line.tokens[0]
    if first.type != "FOR":
        return None
    start, end = token_span(first)
    word = Token("FOREACH", "foreach", start_pos=start, end_pos=end)
    location = wrong.source.location(token_span(first))
    hint = Help("over the objects of a type: `foreach x: T:`", Replacement(location, "foreach"))
    before = wrong.line.tokens[1 : wrong.line.tokens.index(wrong.token)]
    tokens = (word, *before, wrong.token)
    return Correction(wrong.diagnose(hint), tokens, offset=1 - len(tokens), length=len(tokens))


def _header(wrong: Unexpected) -> Correction | None:
    """A misspelt or foreign word where a definition or section starts."""
    word = str(wrong.token)
    if wrong.wants_header and wrong.following in ("NAME", "LSQB", "STRING", "COLON"):
        meant = _meant(word, _HEADERS, _OTHER_HEADERS)
    elif wrong.wants_section and wrong.following == "COLON":
        meant = _meant(word, _SECTIONS, _OTHER_SECTIONS)
    else:
        return None
    return None if meant is None else _instead(wrong, meant.upper(), meant)


def _meant(word: str, known: tuple[str, ...], foreign: Mapping[str, str]) -> str | None:
    return foreign.get(word.lower()) or nearest(word, list(known))


# ---------------------------------------------------------------------------------------- reports


def report(wrong: Unexpected, found: Collector) -> None:
    """Say what is wrong with a token for which there is no correction."""
    token = wrong.token
    location = wrong.source.location(token_span(token))
    first = wrong.line.tokens[0]
    if token.type == "RESERVED":
        found.add(errors.ReservedWord(location=location, word=str(token)))
    elif token.type == "ELLIPSIS":
        found.add(errors.Elision(location=location))
    elif first.type == "NAME" and first == "while":
        found.add(errors.WhileLoop(location=wrong.source.location(token_span(first))))
    else:
        hint = _hint(wrong)
        found.add(wrong.diagnose(None if hint is None else Help(hint)))


def _describe(token: Token) -> str:
    match token.type:
        case "_NEWLINE" | "_DEDENT" | "_INDENT" | "$END":
            return "end of line"
        case "NAME":
            return f"name `{token}`"
        case "INT" | "FLOAT":
            return f"number `{token}`" if len(token) <= 40 else "number"
        case "STRING" | "QUOTED":
            return "string"
        case "UNCLOSED":
            return '`"`'
        case "UNREADABLE":
            return f"character `{token}`" if token.isprintable() else f"character {token!a}"
        case _:
            return f"`{token}`"


def _expected(wrong: Unexpected) -> str:
    """What could have stood there, in words; empty when there is too much of it."""
    accepted = wrong.accepted
    if wrong.wants_header:
        return "a definition"
    if wrong.wants_section:
        return "a section: `goal:`, `body:` or `eff:`"
    if {"INT", "NAME", "NOT"} <= accepted:
        return "an expression"
    if {"ACHIEVE", "NAME"} <= accepted:
        return "a statement"
    if {"AND", "_NEWLINE"} <= accepted:
        return "the end of the line"
    names = ["a name"] if "NAME" in accepted else []
    spelled = {**_SPELLED, "IN": ""} if names else _SPELLED
    names += [text for kind, text in spelled.items() if text and kind in accepted]
    return " or ".join(names[:3])


def _hint(wrong: Unexpected) -> str | None:
    token = wrong.token
    if wrong.token.startswith("->") and wrong.line.tokens[0].type in _WITHOUT_VALUE:
        return "only features and functions have a value"
    for word in (wrong.previous, token):
        if word in _OTHER_WORDS:
            return _OTHER_WORDS[word]
    if token.type == "UNREADABLE":
        return _hint_for_character(wrong)
    if wrong.is_first:
        return _hint_for_line(wrong)
    return _hint_for_token(wrong)


def _hint_for_token(wrong: Unexpected) -> str | None:
    return _hint_in_header(wrong) or _hint_in_expression(wrong) or _hint_in_statement(wrong)


def _hint_in_header(wrong: Unexpected) -> str | None:
    """For a token in the line that starts a definition."""
    token, previous, head = wrong.token, wrong.previous, wrong.line.tokens[0].type
    match head, token.type, previous.type:
        case "TYPEDEF", "COMMA", _:
            return "each type has a line of its own"
        case "TYPEDEF", "EQUAL", _:
            return "a more special type is written `typedef T: object`"
        case "FEATURE", "COLON", "RPAR":
            return "the type of its value follows `->`"
        case _, "NAME", "NAME" if head in HEADERS and "COMMA" in wrong.accepted:
            return "a parameter is written `name: type`"
        case _, "_NEWLINE", "NAME" if head in _WITH_PARAMETERS and "LPAR" in wrong.accepted:
            return f"without parameters it is `{wrong.line.tokens[0]} {previous}()`"
        case _:
            return None


def _hint_in_expression(wrong: Unexpected) -> str | None:
    """For a token where an expression stands, or has just ended."""
    token, previous, head = wrong.token, wrong.previous, wrong.line.tokens[0].type
    starts, ended = "INT" in wrong.accepted, "AND" in wrong.accepted
    match token.type, previous.type:
        case (("FORALL" | "EXISTS"), _) if starts:
            return "a quantifier in the middle of an expression needs parentheses around it"
        case "FLOAT", "NAME":
            return "features are read as `f(x)` or `f[x]`, not as `x.f`"
        case "MORETHAN", "LESSTHAN":
            return "not equal is `!=`"
        case "EQUAL", ("EQUALS" | "EQUAL"):
            return "compare with `==`"
        case (("PLUS" | "MINUS"), _) if wrong.following == token.type:
            return f"to count, write `f[x] {token}= 1`"
        case "NAME", "INT":
            return "numbers are decimal, without a unit or suffix"
        case "COMMA", _ if head == "ASSERT" and wrong.following == "STRING":
            return "`assert` has no message; a comment can say it: `# …`"
        case "COMMA", _ if ended:
            return "join conditions with `and`"
        case "LSQB", "RSQB":
            return "all arguments stand in one pair of brackets: `f[x, y]`"
        case "IN", _ if ended:
            return "a type is no set: a variable over it is `exists x: T: c` or `forall x: T: c`"
        case "FOR", _ if ended or "COMMA" in wrong.accepted:
            return "`any(… for x in T)` is `exists x: T: …`, and `all(…)` is `forall x: T: …`"
        case _:
            return None


def _hint_in_statement(wrong: Unexpected) -> str | None:
    """For a token that the form of the statement does not have there."""
    token, previous = wrong.token, wrong.previous
    match token.type, previous.type:
        case (("NAME" | "COLON"), "NAME") if {"LPAR", "EQUAL"} <= wrong.accepted:
            return "a cell is written `f[x] = e`, a new variable `let v = e`"
        case "BIND", "EQUAL":
            return "`bind` introduces the variable itself: `bind x: T where: c`"
        case "EQUAL", "COLON":
            return "assignments are written `v = e`"
        case "_NEWLINE", "WHERE":
            return "the condition follows a colon: `bind x: T where: c`"
        case "_NEWLINE", "DO":
            return "`do` runs a controller: `do c(x)`"
        case _ if "NAME" in wrong.accepted and token.isidentifier() and "INT" not in wrong.accepted:
            return f"`{token}` is a reserved word; choose another name"
        case _, "ELSE":
            return "`else:` stands alone; a further condition is `elif c:`"
        case "COLON", _ if "IN" in {t.type for t in wrong.line.tokens}:
            return "over the objects of a type: `foreach x: T:`; over numbers: `range(n)`"
        case _:
            return None


def _hint_for_line(wrong: Unexpected) -> str | None:
    """For a token that starts a line."""
    kind = wrong.token.type
    if wrong.wants_section and kind in STATEMENTS:
        if wrong.token in _PRECONDITIONS:
            return "a precondition is an `assert` in the `body:`"
        return "statements stand under `body:`, assignments to features under `eff:`"
    if wrong.wants_header and kind in STATEMENTS - {"NAME"}:
        return "statements stand in the `body:` of a behavior"
    if wrong.accepted == {"_DEDENT"}:
        return "a condition is one expression; join several with `and`"
    match kind:
        case "ELIF" | "ELSE":
            return f"there is no `if` right before this `{wrong.token}`"
        case "NOT":
            return "to make it false: `f[x] = False`; to require it: `assert not f(x)`"
        case "DEF":
            return "a `def` stands at the top level of a file"
        case "DOUBLE_SLASH" | "SLASH":
            return "comments start with `#`"
        case "LPAR" if wrong.wants_header:
            return "this looks like PDDL; `cdlc import` translates it"
        case _ if kind in HEADERS and wrong.wants_section:
            return f"a `{wrong.token}` stands at the top level of a file, without indentation"
        case _:
            return None


def _hint_for_character(wrong: Unexpected) -> str | None:
    character = str(wrong.token)
    match character:
        case "?" if "AND" in wrong.accepted:
            return "a choice between two values is written `a if c else b`"
        case "?":
            return "variables are plain names; a parameter is written `name: type`"
        case "'":
            return "strings are written with double quotes and end on their line"
        case "{" | "}":
            return "blocks are written by indentation, without braces"
        case ".":
            return "features are read as `f(x)` or `f[x]`, not as `x.f`"
        case "\\":
            return "lines are joined inside brackets; there is no `\\`"
        case _ if character in _QUOTATION_MARKS:
            return 'the quotation mark of CDL is `"`'
        case _ if character in _SYMBOLS:
            return f"write `{_SYMBOLS[character]}`"
        case _ if character.isidentifier():
            return "names are made of the letters a-z and A-Z, digits and `_`"
        case _:
            return None
