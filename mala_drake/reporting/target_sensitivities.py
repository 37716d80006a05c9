"""What targets were learned through: how far the simulated sensitivities of legs were from doing nothing."""

from __future__ import annotations

from collections import Counter
from typing import Any

from mala_drake.experiments.target_summary import deviations_of
from mala_drake.messages import SensitivitySource
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.result_tables import NONE, number
from mala_drake.reporting.results import Results
from mala_drake.reporting.table import Group, Row, Table
from mala_drake.reporting.wording import words

_COLUMNS = (
    ("simulated", SensitivitySource.SIMULATED),
    ("fallback", SensitivitySource.FALLBACK),
    ("identity", SensitivitySource.IDENTITY),
    ("not needed", SensitivitySource.NOT_NEEDED),
)


def sensitivity_table(results: Results) -> tuple[Table, ...]:
    """By condition, what the updates of targets went through; no table where the results do not tell it."""
    moves = {condition: _moves(results, condition) for condition in results.conditions}
    rows = [_row(words(results.learner(condition)), legs) for condition, legs in moves.items() if legs]
    if not rows:
        return ()
    caption = (
        "Updates of targets, by the sensitivity S of the leg's end to its target that they went through. Simulated: S "
        "of the leg, simulated in closed loop. Fallback: the identity I, because the simulation failed or S was more "
        "than 0.5 off I. Identity: I, as the condition wants it. Not needed: the leg was not driven to its end, and "
        "the update is about where the robot stood. S − I: 2-norm of the difference for all S that were simulated, "
        "used or not, median (greatest); where it is small, learning through S is learning through I."
    )
    return (
        Table(
            "target_sensitivities",
            caption,
            ("condition", "updates", *(heading for heading, _ in _COLUMNS), "S − I"),
            (Group(tuple(rows)),),
        ),
    )


def sensitivity_sentences(results: Results) -> tuple[str, ...]:
    """The same of the main condition, in a sentence; none where the results do not tell it."""
    legs = _moves(results, results.main)
    if not legs:
        return ()
    sources, deviations = _sources(legs), deviations_of(legs)
    simulated, fallback = sources[SensitivitySource.SIMULATED.value], sources[SensitivitySource.FALLBACK.value]
    text = (
        f"Of {len(legs)} updates, {simulated} went through the simulated sensitivity of the leg's end and {fallback} "
        "fell back to the identity"
    )
    if deviations:
        text += f"; what was simulated differed from the identity by {number(max(deviations), 3)} at most (2-norm)"
    return (text + ".",)


def _moves(results: Results, condition: str) -> list[dict[str, Any]]:
    """The legs of a condition after which a target was moved, and that tell through what."""
    legs = (leg for run in results.of(condition) for record in run.episodes for leg in record.displaced_legs)
    return [leg for leg in legs if leg["moved"] and leg.get("sensitivity")]


def _sources(legs: list[dict[str, Any]]) -> Counter[str]:
    return Counter(str(leg["sensitivity"]) for leg in legs)


def _row(name: str, legs: list[dict[str, Any]]) -> Row:
    sources, deviations = _sources(legs), deviations_of(legs)
    counted = (str(sources[source.value]) for _, source in _COLUMNS)
    spread = f"{number(quantile(deviations, 0.5), 3)} ({number(max(deviations), 3)})" if deviations else NONE
    return (name, str(len(legs)), *counted, spread)
