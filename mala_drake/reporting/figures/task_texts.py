"""What is written into a task's graph: facts, actions and places in the words of the PDDL, made short."""

from __future__ import annotations

import textwrap
from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence

from mala_drake.planning.syntax import Description, Fact
from mala_drake.reporting.task_graph import State
from mala_drake.reporting.wording import words

_LONGEST = 18  # Characters of a line.


class TaskTexts:
    """Texts of one task."""

    def __init__(self, description: Description, facts: Iterable[Fact]) -> None:
        """Looks at all `facts` that will be told: arguments in which those of a predicate agree are left out."""
        self._description = description
        arguments: dict[str, set[tuple[str, ...]]] = defaultdict(set)
        for predicate, *objects in facts:
            arguments[predicate].add(tuple(objects))
        self._telling = {
            predicate: [i for i, each in enumerate(zip(*found, strict=True)) if len(set(each)) > 1]
            for predicate, found in arguments.items()
        }

    def facts(self, gained: Collection[Fact], states: Sequence[State]) -> str:
        """The facts that have become true on the way into some states, as far as each of the states has one of them.

        What is true in all the states is joined by `and`, what differs between them by `or`.
        """
        common = frozenset.intersection(*states)
        by_predicate: dict[str, list[Fact]] = defaultdict(list)
        for fact in sorted(gained):
            by_predicate[fact[0]].append(fact)
        lines = []
        for predicate, found in by_predicate.items():
            if all(any(fact in state for fact in found) for state in states):
                in_all = " and ".join(self._objects(fact) for fact in found if fact in common)
                in_some = " or ".join(self._objects(fact) for fact in found if fact not in common)
                objects = " and ".join(text for text in (in_all, in_some) if text)
                lines += _wrapped(f"{words(predicate)} {objects}".strip())
        return "\n".join(lines)

    def _objects(self, fact: Fact) -> str:
        return " ".join(words(fact[1 + i]) for i in self._telling[fact[0]])

    def action(self, actions: Sequence[str], places: Sequence[str]) -> str:
        """Actions, and on a line of its own where they can be done."""
        lines = _wrapped(_alternatives([words(action) for action in actions]))
        return "\n".join([*lines, *(_wrapped(f"at {self.places(places)}") if places else [])])

    def places(self, places: Sequence[str]) -> str:
        """Some places; all of a kind by the kind's name."""
        kind = self.kind(places)
        if kind and set(places) == set(self._description.objects_of((kind,))):
            return f"any {words(kind)}" if len(places) > 1 else words(places[0])
        return _alternatives([words(place) for place in places])

    def kind(self, places: Sequence[str]) -> str | None:
        """The type that all of some places have; None if they differ or there are none."""
        kinds = {self._description.objects[place] for place in places}
        return kinds.pop() if len(kinds) == 1 else None


def _alternatives(texts: Sequence[str]) -> str:
    """Several texts, with what they have in common at the beginning said once: `collect a or b`."""
    if not texts:
        return ""
    split = [text.split() for text in dict.fromkeys(texts)]
    common = 0
    while all(len(each) > common + 1 for each in split) and len({each[common] for each in split}) == 1:
        common += 1
    return " ".join([*split[0][:common], " or ".join(" ".join(each[common:]) for each in split)])


def _wrapped(text: str) -> list[str]:
    """As few lines as there have to be, of about the same length."""
    lines = textwrap.wrap(text, _LONGEST)
    for width in range(_LONGEST - 1, max(map(len, text.split()), default=1) - 1, -1):
        shorter = textwrap.wrap(text, width)
        if len(shorter) > len(lines):
            break
        lines = shorter
    return lines
