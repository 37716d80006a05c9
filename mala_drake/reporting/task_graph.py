"""The state-transition graph of a planning task, made small enough to be read.

It follows from the PDDL files alone, in four steps:

1. All facts that the initial state can lead to are explored, up to the goal. Numbers (charge, time, cost) are left
   out: an action counts as applicable where its facts allow it.
2. Where the robot is is projected out, so that movements, which change nothing else, vanish. What is left of them is
   the places at which each action can be done.
3. Facts that no action short of the goal reads or changes together belong to different parts of the task, which can be
   worked on in any order: each part is a graph of its own, and the actions that reach the goal need all of them.
4. In each part, states with the same future are one node: the coarsest bisimulation by names of actions.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from mala_drake.planning.ground_task import Condition, GroundAction, GroundTask
from mala_drake.planning.syntax import Fact
from mala_drake.planning.task import PlanningTask

State = frozenset[Fact]

_MOST_STATES = 100_000  # More than that is no graph for people.


@dataclass(frozen=True)
class Edge:
    """Actions that lead from one node of a part to another.

    Attributes:
        source: number of the node.
        target: number of the node.
        actions: names of their schemas, sorted; with objects where one name leads from the source to several nodes.
        places: where they can be done (a movement: where it leads), sorted; empty when that is anywhere.
        gained: the facts that they make true.
    """

    source: int
    target: int
    actions: tuple[str, ...]
    places: tuple[str, ...]
    gained: State


@dataclass(frozen=True)
class Part:
    """A part of a task that can be worked on by itself. Node 0 is where it begins.

    Attributes:
        nodes: the states of each node, as the facts of this part that are true in them.
        edges: between them, sorted.
        ready: the nodes in which the part is ready for the actions that reach the goal.
    """

    nodes: tuple[tuple[State, ...], ...]
    edges: tuple[Edge, ...]
    ready: tuple[int, ...]


@dataclass(frozen=True)
class TaskGraph:
    """A task as parts, and the actions that reach the goal when all parts are ready.

    Attributes:
        parts: those with anything to do.
        goal_actions: names of their schemas, sorted.
        goal_places: where these can be done, sorted.
        states: reachable states before anything was merged, without numbers.
    """

    parts: tuple[Part, ...]
    goal_actions: tuple[str, ...]
    goal_places: tuple[str, ...]
    states: int


@dataclass(frozen=True, slots=True)
class _Step:
    """A transition between states of facts."""

    before: State
    action: GroundAction
    after: State


def task_graph(task: PlanningTask, *, location: str = "at") -> TaskGraph:
    """The graph of a task.

    Args:
        task: with its initial state.
        location: the predicate, of two arguments, that says where the robot is.

    Raises:
        ValueError: if there are too many states, or none of them is a goal.
    """
    ground = task.grounding(task.initial_state).ground_task
    steps, goals = _explore(ground, task.initial_state.facts & ground.reached)
    states = {state for step in steps for state in (step.before, step.after)}
    if not goals:
        raise ValueError("no goal can be reached")
    everywhere = frozenset.intersection(*states)
    ignored = everywhere | {fact for state in states for fact in state if fact[0] == location}
    last = [step for step in steps if step.after in goals]
    last_names = {step.action.name for step in last}
    parts = []
    for facts in _components(steps, last_names, ignored):
        part = _part(facts, steps, last, location)
        if part.edges:
            parts.append(part)
    return TaskGraph(
        tuple(parts),
        tuple(sorted({_schema(step.action) for step in last})),
        tuple(sorted({place for step in last for place in _place(step, location)})),
        len(states),
    )


def _explore(task: GroundTask, initial: State) -> tuple[list[_Step], set[State]]:
    """Every transition from the reachable states that are no goal, and the goals."""
    steps: list[_Step] = []
    goals: set[State] = set()
    seen, queue = {initial}, [initial]
    for state in queue:
        if task.goal is not None and _holds(task.goal, state):
            goals.add(state)
            continue
        for action in task.actions:
            if _holds(action.precondition, state):
                after = _apply(action, state)
                steps.append(_Step(state, action, after))
                if after not in seen:
                    seen.add(after)
                    queue.append(after)
        if len(seen) > _MOST_STATES:
            raise ValueError(f"more than {_MOST_STATES} states")
    return steps, goals


def _holds(condition: Condition, state: State) -> bool:
    """Whether the facts of a condition hold; its comparisons of numbers are taken to."""
    return (
        condition.positive <= state
        and not condition.negative & state
        and all(any(_holds(part, state) for part in choice) for choice in condition.choices)
    )


def _apply(action: GroundAction, state: State) -> State:
    added: set[Fact] = set()
    deleted: set[Fact] = set()
    for effect in action.effects:
        # An effect that depends on a number is not one of the facts.
        if not effect.condition.comparisons and _holds(effect.condition, state):
            added |= effect.added
            deleted |= effect.deleted
    return frozenset((state - deleted) | added)


def _schema(action: GroundAction) -> str:
    return action.name.strip("()").split()[0]


def _place(step: _Step, location: str) -> tuple[str, ...]:
    """Where a step is done: where the robot is after it."""
    return tuple(fact[-1] for fact in step.after if fact[0] == location)


def _read(condition: Condition) -> Iterator[Fact]:
    for part in condition.parts():
        yield from part.positive
        yield from part.negative


def _components(steps: Sequence[_Step], last: Collection[str], ignored: Collection[Fact]) -> list[State]:
    """Facts that belong together, sorted by their first ones.

    Together belong what an action that does not reach the goal reads or changes, and what decides in different ways
    whether the goal can be reached: what is left must be true in all of these ways.
    """
    actions = {step.action.name: step.action for step in steps}
    linked = [_touched(action) for name, action in actions.items() if name not in last]
    ways = [_literals(actions[name].precondition) for name in sorted(last)]
    linked.append({fact for way in ways for fact, _ in way - frozenset.intersection(*ways)})
    linked += [set(_read(part)) for name in last for part in actions[name].precondition.parts() if part.choices]
    groups = {fact: {fact} for name in last for fact in _touched(actions[name]) - set(ignored)}
    for facts in linked:
        merged = facts - set(ignored)
        merged = merged.union(*(groups.get(fact, set()) for fact in merged))
        groups.update(dict.fromkeys(merged, merged))
    found = sorted({frozenset(group) for group in groups.values()}, key=min)
    short = [step for step in steps if step.action.name not in last]
    return found if _independent(short, found) else [frozenset().union(*found)]


def _independent(steps: Iterable[_Step], parts: Sequence[State]) -> bool:
    """Whether every part can be worked on in every state of the others.

    Facts that no action joins may still depend on each other by where the robot is: when it cannot turn back, say.
    """
    together = frozenset().union(*parts)
    states = {state & together for step in steps for state in (step.before, step.after)}
    changes = {(s.before & together, s.action.name, s.after & together) for s in steps}
    changes = {(before, name, after) for before, name, after in changes if before != after}
    possible = 0
    for part in parts:
        others = math.prod(len({state & other for state in states}) for other in parts if other != part)
        own = {(before & part, name, after & part) for before, name, after in changes if before & part != after & part}
        possible += len(own) * others
    return len(changes) == possible


def _touched(action: GroundAction) -> set[Fact]:
    facts = set(_read(action.precondition))
    for effect in action.effects:
        facts |= effect.added | effect.deleted | set(_read(effect.condition))
    return facts


def _literals(condition: Condition) -> frozenset[tuple[Fact, bool]]:
    return frozenset({(fact, True) for fact in condition.positive} | {(fact, False) for fact in condition.negative})


def _part(facts: State, steps: Iterable[_Step], last: Sequence[_Step], location: str) -> Part:
    """The graph of some facts, its states merged by their future."""
    ready = {step.before & facts for step in last}
    finished = {step.after for step in last}
    order = dict.fromkeys(
        state & facts for step in steps for state in (step.before, step.after) if state not in finished
    )
    changing = [step for step in steps if step.before & facts != step.after & facts and step.after not in finished]
    block = bisimulation(
        tuple(order), [(s.before & facts, _schema(s.action), s.after & facts) for s in changing], ready
    )
    by_edge: dict[tuple[int, int], list[_Step]] = defaultdict(list)
    targets: dict[tuple[int, str], set[int]] = defaultdict(set)
    for step in changing:
        source, target = block[step.before & facts], block[step.after & facts]
        by_edge[source, target].append(step)
        targets[source, _schema(step.action)].add(target)
    everywhere = {place for step in steps for place in _place(step, location)}
    told = _telling_objects(changing, everywhere)
    edges = []
    for (source, target), found in sorted(by_edge.items()):
        names = {
            " ".join((name, *told[step.action.name])) if len(targets[source, name]) > 1 else name
            for step in found
            if (name := _schema(step.action))
        }
        places = {place for step in found for place in _place(step, location)}
        anywhere = len(places) > len(everywhere) / 2
        gained = frozenset(fact for step in found for fact in (step.after - step.before) & facts)
        edges.append(Edge(source, target, tuple(sorted(names)), () if anywhere else tuple(sorted(places)), gained))
    members: dict[int, list[State]] = defaultdict(list)
    for state, number in block.items():
        members[number].append(state)
    nodes = tuple(tuple(members[number]) for number in range(len(members)))
    return Part(nodes, tuple(edges), tuple(sorted({block[state] for state in ready})))


def _telling_objects(steps: Iterable[_Step], places: Collection[str]) -> Mapping[str, tuple[str, ...]]:
    """The objects of each action that are no places and not the same in all actions."""
    objects = {step.action.name: step.action.name.strip("()").split()[1:] for step in steps}
    common = set.intersection(*map(set, objects.values())) if objects else set()
    return {name: tuple(each for each in found if each not in {*common, *places}) for name, found in objects.items()}


def bisimulation(
    states: Sequence[State], edges: Iterable[tuple[State, str, State]], ready: Collection[State]
) -> dict[State, int]:
    """The coarsest partition in which equal blocks have equal actions into equal blocks (by partition refinement).

    Blocks are numbered in the order of `states`.
    """
    following: dict[State, set[tuple[str, State]]] = defaultdict(set)
    for before, name, after in edges:
        following[before].add((name, after))
    block = {state: int(state in ready) for state in states}
    while True:
        numbers: dict[tuple[int, frozenset[tuple[str, int]]], int] = {}
        refined = {}
        for state in states:
            signature = (block[state], frozenset((name, block[after]) for name, after in following[state]))
            refined[state] = numbers.setdefault(signature, len(numbers))
        if len(numbers) == len(set(block.values())):
            return refined
        block = refined
