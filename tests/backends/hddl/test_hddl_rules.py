"""Single rules of the translation, and what HDDL has no form for."""

import re

import pytest
from hddl_tasks import hddl_of, stated

BOXES = """
    typedef box
    feature open(x: box)
    feature full(x: box)
    feature red(x: box)
    feature inside(x: box) -> box
    controller lift(x: box)
    controller tip(x: box)
    behavior open_it(x: box):
      goal: open(x)
      body:
        do lift(x)
      eff:
        open[x] = True
"""


def domain_of(more: str) -> str:
    task, found = hddl_of(BOXES + more)
    assert task is not None, [d.message() for d in found]
    return re.sub(r" *;.*", "", task.domain)


def section(text: str, kind: str, name: str) -> str:
    """A task or method, on one line."""
    (found,) = re.findall(rf"\(:{kind} {name}\n(.*?)(?=\n  \(:|\)\n$)", text, re.DOTALL)
    return re.sub(r"\s+", " ", found).strip()


def test_a_behavior_is_a_method_that_ends_with_its_action() -> None:
    text = domain_of("")
    assert section(text, "task", "achieve-open") == ":parameters (?x - box))"
    assert section(text, "method", "open-holds") == (
        ":parameters (?x - box) :task (achieve-open ?x) :precondition (and (open ?x)))"
    )
    assert section(text, "method", "open_it") == (
        ":parameters (?x - box) :task (achieve-open ?x) :ordered-subtasks (and (lift ?x)))"
    )


def test_an_early_if_makes_two_methods_and_a_late_one_a_task() -> None:
    text = domain_of("""
    behavior early(x: box):
      goal: full(x)
      body:
        if red(x):
          achieve open(x)
        bind y: box where: inside(y) == x
        achieve open(y)
        if open(x):
          achieve open(y)
    """)
    assert ":precondition (and (red ?x) (inside ?y ?x))" in section(text, "method", "early")
    late = section(text, "method", "early-2")
    assert ":precondition (and (not (red ?x)) (inside ?y ?x))" in late
    assert late.endswith(":ordered-subtasks (and (achieve-open ?y) (early-part-1 ?x ?y)))")
    assert section(text, "task", "early-part-1") == ":parameters (?x ?y - box))"
    assert "(open ?x)" in section(text, "method", "early-part-1-way")
    assert "(not (open ?x))" in section(text, "method", "early-part-1-way-2")


def test_a_promotable_section_is_in_no_order_and_its_if_is_decided_at_its_start() -> None:
    text = domain_of("""
    behavior fill(x: box, y: box):
      goal: full(x)
      body:
        promotable:
          if red(x):
            achieve open(x)
          achieve open(y)
        achieve not red(y)
    """)
    assert section(text, "method", "fill") == (
        ":parameters (?x ?y - box) :task (achieve-full ?x) :precondition (and (red ?x))"
        " :subtasks (and (t1 (achieve-open ?x)) (t2 (achieve-open ?y))"
        " (t3 (achieve-not-red ?y))) :ordering (and (< t1 t3) (< t2 t3)))"
    )
    # Nothing has it as its goal, so it can only be true.
    assert section(text, "method", "not-red-holds").endswith(":precondition (and (not (red ?x))))")
    assert text.count(":task (achieve-not-red") == 1


def test_conditions_stand_where_they_stand_unless_the_action_has_them() -> None:
    text = domain_of("""
    behavior fill(x: box):
      goal: full(x)
      body:
        achieve open(x)
        assert red(x)
        do tip(x)
      eff:
        full[x] = True
    behavior bare(x: box):
      goal: not full(x)
      body:
        achieve open(x)
        assert full(x)
        achieve open(inside(x))
    """)
    assert section(text, "method", "fill").endswith(
        ":task (achieve-full ?x) :precondition (and (red ?x))"
        " :ordered-subtasks (and (achieve-open ?x) (tip ?x)))"
    )  # `red` never changes
    assert section(text, "method", "bare").endswith(
        ":precondition (and (inside ?x ?x_2)) :ordered-subtasks (and (achieve-open ?x)"
        " (bare-part-1 ?x) (achieve-open ?x_2)))"
    )


def test_goals_with_constants_and_repeated_parameters_are_equalities() -> None:
    text = domain_of("""
    object_constant chest: box
    feature beside(x: box, y: box)
    behavior by_itself(y: box):
      goal: beside(y, y)
      body:
        achieve open(y)
    behavior in_chest(x: box):
      goal: inside(x) == chest
      body:
        achieve open(chest)
    """)
    itself = section(text, "method", "by_itself")
    assert ":task (achieve-beside ?y ?y_2) :precondition (and (= ?y ?y_2))" in itself
    chest = section(text, "method", "in_chest")
    assert ":task (achieve-inside ?x ?value) :precondition (and (= ?value chest))" in chest
    assert chest.endswith("(achieve-open chest)))")


def test_a_loop_goes_along_the_objects_and_each_variable_has_one() -> None:
    text = domain_of("""
    typedef lid
    feature fits(x: box, y: lid)
    behavior all_open():
      goal: full(chest)
      body:
        foreach x: box, y: lid:
          achieve fits(x, y)
    object_constant chest: box
    """)
    rest = section(text, "method", "all_open-part-2-way")
    assert ":precondition (and (next-box ?x ?next))" in rest
    assert ":subtasks (and (t1 (all_open-part-3 ?x)) (t2 (all_open-part-2 ?next))))" in rest
    assert ":ordering" not in rest
    assert "(achieve-fits ?x ?y)" in section(text, "method", "all_open-part-6-way")
    problem = (
        'problem "p"\nobjects:\n  a, b: lid\ninit:\n  inside[chest] = chest\ngoal: full(chest)'
    )
    task = stated(BOXES + "    object_constant chest: box\n" + LOOP, problem).task
    assert task.problem is not None
    facts = re.findall(r"\((first|next|last|no)-(\S+?)( [^)]*)?\)", task.problem)
    assert facts == [
        ("first", "box", " chest"),
        ("last", "box", " chest"),
        ("first", "lid", " a"),
        ("next", "lid", " a b"),
        ("last", "lid", " b"),
        ("no", "cup", ""),
    ]


LOOP = """
    typedef lid
    typedef cup
    feature fits(x: box, y: lid)
    feature clean(c: cup)
    behavior all_open(b: box):
      goal: full(b)
      body:
        foreach x: box, y: lid:
          achieve fits(x, y)
        foreach c: cup:
          achieve clean(c)
"""


def test_an_alternative_is_a_method_each_and_a_comparison_of_two_values_too() -> None:
    text = domain_of("""
    feature at(x: box) -> box
    behavior move(x: box, y: box):
      goal: at(x) == y
      body:
        do lift(x)
      eff:
        at[x] = y
    behavior put(x: box, y: box):
      goal: inside(x) == y
      body:
        do tip(x)
      eff:
        inside[x] = y
    behavior choose(x: box):
      goal: full(x)
      body:
        alternative:
          achieve open(x)
          achieve at(x) == inside(x)
    """)
    assert "(achieve-open ?x)" in section(text, "method", "choose")
    at, inside = (section(text, "method", f"choose-{n}") for n in (2, 3))
    assert ":precondition (and (inside ?x ?value)) :ordered-subtasks (and (achieve-at ?x" in at
    assert ":precondition (and (at ?x ?value)) :ordered-subtasks (and (achieve-inside ?x" in inside


def test_each_alternative_ends_with_its_own_action() -> None:
    text = domain_of("""
    behavior fill(x: box):
      goal: full(x)
      body:
        alternative:
          do lift(x)
          sequential:
            assert red(x)
            do tip(x)
      eff:
        full[x] = True
    """)
    assert ":subtasks (and (fill ?x))" in section(text, "method", "fill-2").replace("ordered-", "")
    assert "fill-way" not in text
    tips = re.findall(r"\(tip \?x\)", text)
    assert len(tips) == 1, text


def test_methods_of_controllers_with_effects_run_their_actions() -> None:
    text = domain_of("""
    controller close(x: box):
      eff:
        open[x] = False
    behavior shut(x: box):
      goal: not open(x)
      body:
        bind y: box where: inside(y) == x
        achieve open(y)
        do close(y)
        do close(x)
    """)
    shut = section(text, "method", "shut")
    assert shut.endswith(":ordered-subtasks (and (achieve-open ?y) (close ?y) (close ?x)))")


def test_names_of_tasks_and_methods_are_apart_from_all_others() -> None:
    text = domain_of("""
    controller run(x: box)
    behavior lid(x: box):
      eff:
        full[x] = True
    behavior opened(x: box):
      goal: full(x)
      body:
        lid(x)
    """)
    names = re.findall(r"\(:(?:task|method|action) (\S+)", text)
    assert len({name.lower() for name in names}) == len(names)
    assert "(:action lid\n" in text
    assert section(text, "method", "lid-2").endswith(":ordered-subtasks (and (lid ?x)))")


REFUSED = {
    "a call": (
        """
    behavior help(x: box):
      body:
        achieve open(x)
        do tip(x)
    behavior fill(x: box):
      goal: full(x)
      body:
        help(x)
      eff:
        full[x] = True
    """,
        (
            "a call of `help`, which does more than run controllers, in a behavior with an effect"
            " of its own, has no HDDL"
        ),
    ),
    "phases": (
        """
    behavior fill(x: box, y: box):
      goal: full(x)
      body:
        do tip(x)
        achieve open(y)
        do tip(y)
      eff:
        full[x] = True
    """,
        "`fill`, which achieves something after it has acted, has no HDDL",
    ),
    "a number": (
        "    feature size(x: box) -> int64\n",
        "`size`, a number, has no HDDL",
    ),
    "a value": (
        """
    behavior wait(x: box, time: int64):
      body:
        achieve open(x)
    """,
        "parameter `time` of `wait`, of type `int64`, has no HDDL",
    ),
    "a late let": (
        """
    behavior fill(x: box):
      goal: full(x)
      body:
        let was_open = open(x)
        achieve open(x) and was_open
    """,
        "`let was_open`, whose value of type `bool` is used after others act, has no HDDL",
    ),
    "choices": (
        """
    behavior fill(x: box):
      goal: full(x)
      body:
"""
        + "        alternative:\n          achieve open(x)\n          achieve red(x)\n" * 7,
        "a body with more than 64 choices has no HDDL",
    ),
    "a bind of a value": (
        """
    behavior fill(x: box):
      goal: full(x)
      body:
        bind n: int64
        achieve open(x)
    """,
        "`bind n` of type `int64` has no HDDL",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_has_no_hddl_is_refused_with_its_place(case: str) -> None:
    more, message = REFUSED[case]
    task, found = hddl_of(BOXES + more)
    assert task is None
    (diagnostic,) = [d for d in found if d.severity == "error"]
    assert (diagnostic.code, diagnostic.message()) == ("not-in-format", message)
    assert diagnostic.location.line > BOXES.count("\n")
    assert diagnostic.help()


def test_a_long_chain_of_goals_is_no_recursion() -> None:
    more = "".join(
        f"    feature f{n}(x: box)\n    behavior b{n}(x: box):\n      goal: f{n}(x)\n"
        f"      body:\n        achieve f{n + 1}(x)\n"
        for n in range(600)
    )
    text = domain_of(more + "    feature f600(x: box)\n")
    assert text.count("(:task achieve-f") == 601


def test_a_goal_is_taken_apart_over_the_objects_of_the_problem() -> None:
    problem = """
    problem "p"
    objects:
      a, b: box
    init:
      inside[a] = b
      inside[b] = b
    goal:
      (forall x: box: open(x)) and (exists y: box: not red(y) and y != a)
    """
    task = stated(BOXES, problem).task
    assert task.problem is not None
    (network,) = re.findall(r"\(:htn\n(.*?)\n  \(:init", task.problem, re.DOTALL)
    assert re.sub(r"\s+", " ", network).strip() == (
        ":parameters (?y - box) :subtasks (and (t1 (achieve-open a)) (t2 (achieve-open b))"
        " (t3 (achieve-not-red ?y)) (t4 (goal-part-1 a ?y))))"
    )
