"""Tables of displaced targets: place by place and condition by condition, beside the paper's figures."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mala_drake.reporting.paper_results import PAPER_TARGET_UPDATES
from mala_drake.reporting.quantiles import quantile, spread
from mala_drake.reporting.result_tables import NONE, counts, number, percent
from mala_drake.reporting.results import Results
from mala_drake.reporting.table import Group, Row, Table
from mala_drake.reporting.target_results import TargetRun, places_of, target_runs
from mala_drake.reporting.wording import title_of, words
from mala_drake.ward.ward_map import Ward


def target_table(results: Results, ward: Ward) -> Table:
    """Each displaced place under each condition, and what the paper reports of it."""
    found = {condition: target_runs(results, ward, condition) for condition in results.conditions}
    groups = []
    for place in places_of([run for runs in found.values() for run in runs]):
        of_place = {name: [run for run in runs if run.place == place] for name, runs in found.items()}
        rows = [_row(words(results.learner(name)), runs) for name, runs in of_place.items() if runs]
        if place in PAPER_TARGET_UPDATES:
            first, last = PAPER_TARGET_UPDATES[place]
            updates = f"{first}–{last}" if first < last else f"about {first}"
            rows.append(("paper", NONE, NONE, updates, NONE, NONE, NONE, NONE, NONE))
        groups.append(Group(tuple(rows), title_of(place)))
    groups.append(Group(tuple(_row(words(results.learner(name)), runs) for name, runs in found.items() if runs), "All"))
    headings = (
        "condition",
        "runs",
        "gone",
        "updates",
        "most updates",
        "map off by, m",
        "target off by, m",
        "delivered before",
        "delivered after",
    )
    caption = (
        "Runs that drove to the place. Gone: in how many of them the mismatch was gone for good, that is, the last "
        "legs to the place all stopped without mismatch, with everything there within reach; updates: how often the "
        "target had been moved until then, median (quartiles), never where it was not gone. Distances from the true "
        "place: of the place by the map, median; of the target after the last episode, median (greatest). Delivered: "
        "of the episodes that led to the place, before the mismatch was gone (with the one in which it went) and "
        "after. The paper reports after how many updates a target came to rest, wherever that was."
    )
    return Table("targets", caption, headings, tuple(groups))


def _row(name: str, runs: Sequence[TargetRun]) -> Row:
    updates = [run.updates_until_gone for run in runs]
    gone = [count for count in updates if count is not None]
    finals = [run.distances[-1] for run in runs]
    before, after = zip(*(run.deliveries() for run in runs), strict=True)
    return (
        name,
        str(len(runs)),
        f"{len(gone)}/{len(runs)}",
        counts(spread(math.inf if count is None else float(count) for count in updates)),
        str(max(gone)) if gone else NONE,
        number(quantile((run.distances[0] for run in runs), 0.5), 2),
        f"{number(quantile(finals, 0.5), 2)} ({number(max(finals), 2)})",
        _share(before),
        _share(after),
    )


def _share(counted: Sequence[tuple[int, int]]) -> str:
    done, tried = (sum(column) for column in zip(*counted, strict=True))
    return f"{done}/{tried}" if tried else NONE


def target_condition_table(results: Results, ward: Ward) -> Table:
    """What each condition came to as a whole: deliveries, their duration, and how far targets are off at the end."""
    rows = []
    for condition in results.conditions:
        runs = results.of(condition)
        records = [record for run in runs for record in run.episodes]
        halves = [run.episodes[: (len(run.episodes) + 1) // 2] for run in runs]
        late = [record for run, half in zip(runs, halves, strict=True) for record in run.episodes[len(half) :]]
        early = [record for half in halves for record in half]
        targets = target_runs(results, ward, condition)
        finals = [run.distances[-1] for run in targets]
        delivered = spread(record.sim_time_s for record in records if record.success)
        rows.append(
            (
                words(results.learner(condition)),
                str(len(records)),
                percent(sum(record.success for record in records), len(records)),
                f"{sum(record.success for record in early)}/{len(early)}",
                f"{sum(record.success for record in late)}/{len(late)}",
                number(delivered.median, 0),
                f"{number(quantile(finals, 0.5), 2)} ({number(quantile(finals, 1.0), 2)})",
                number(sum(record.mismatches for record in records) / len(records), 1),
                number(quantile((run.learning.final_distance for run in runs), 0.5), 3),
                str(sum(record.collisions for record in records)),
            )
        )
    headings = (
        "condition",
        "episodes",
        "delivered",
        "first half",
        "second half",
        "duration, s",
        "targets off by, m",
        "mismatches",
        "final d",
        "collisions",
    )
    caption = (
        "Episodes delivered on the physics, in all and in the first and the second half of each run. Duration: of the "
        "delivered episodes, median. Targets: distance from the true place after the last episode, median (greatest) "
        "over places and runs. Mismatches: actions an episode after which the symbolic state was not the expected one. "
        "Final d: distance to the patient's true weights, median."
    )
    return Table("target_conditions", caption, headings, (Group(tuple(rows[:1])), Group(tuple(rows[1:]))))
