"""What a report says in words, all of it from the data: the few figures that matter, and everything that went wrong."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from mala_drake.learning.convergence import CONVERGED_DISTANCE
from mala_drake.reporting.bound_results import final_error_over_bound, known_runs, rating_noise
from mala_drake.reporting.paper_results import PAPER_RESULTS
from mala_drake.reporting.profile_results import ProfileResults, profile_results
from mala_drake.reporting.quantiles import quantile
from mala_drake.reporting.result_tables import compared_conditions, number, percent
from mala_drake.reporting.results import Results, Run
from mala_drake.reporting.wording import readable_variant, words

_MOST_NAMED = 8  # Places of a failure that are named one by one.


@dataclass(frozen=True)
class Figure:
    """A figure of the headline: what it is, and whether it is all it should be (None when that is not the question)."""

    value: str
    meaning: str
    good: bool | None = None


def headline(results: Results) -> tuple[Figure, ...]:
    """The few figures that matter, of the main condition."""
    figures = profile_results(results, results.main)
    runs = results.of(results.main)
    episodes, successes = sum(each.episodes for each in figures), sum(each.successes for each in figures)
    collisions = sum(each.collisions for each in figures)
    converged = sum(each.converged for each in figures)
    known = [each for each in figures if each.dominant_right is not None]
    asked, right = sum(len(each.runs) for each in known), sum(each.dominant_right or 0 for each in known)
    final = quantile((run.learning.final_distance for run in runs), 0.5)
    found = [
        Figure(f"{successes}/{episodes}", "tasks done on the physics", successes == episodes),
        Figure(str(collisions), "collisions", collisions == 0),
        Figure(
            f"{converged}/{len(runs)}",
            f"runs understood the patient (d ≤ {CONVERGED_DISTANCE:g})",
            converged == len(runs),
        ),
        Figure(_rated(figures), "rated episodes until then, median"),
        Figure(number(final, 3), "distance at the end, median"),
    ]
    if known:
        found.append(Figure(f"{right}/{asked}", "runs know what matters most", right == asked))
    return tuple(found)


def _rated(figures: Sequence[ProfileResults]) -> str:
    episodes = [math.inf if e is None else float(e) for each in figures for e in each.convergence_episodes]
    return number(quantile(episodes, 0.5), 1).removesuffix(".0")


def problems(results: Results) -> tuple[str, ...]:
    """Everything that went wrong or is missing, under any condition, in sentences; the main condition first."""
    found: list[str] = []
    for condition in results.conditions:
        found += _problems(results, condition)
    return (*found, *results.notes)


def _problems(results: Results, condition: str) -> Iterator[str]:
    runs = results.of(condition)
    under = "" if condition == results.main else f"Under {words(condition)}: "
    episodes = sum(len(run.episodes) for run in runs)
    failed = [(run, record) for run in runs for record in run.episodes if not record.success]
    if failed:
        reasons = Counter(record.failure or "no reason given" for _, record in failed)
        told = "; ".join(
            f"{count} × {reason}" for reason, count in sorted(reasons.items(), key=lambda e: (-e[1], e[0]))
        )
        at = _places([f"{_run(run)}, episode {record.episode + 1}" for run, record in failed])
        yield f"{under}{len(failed)} of {_count(episodes, 'episode')} failed ({told}): {at}."
    touched = [(run, record) for run in runs for record in run.episodes if record.collisions]
    if touched:
        at = _places([f"{_run(run)}, episode {record.episode + 1}" for run, record in touched])
        count = sum(record.collisions for _, record in touched)
        yield f"{under}{_count(count, 'collision')} in {_count(len(touched), 'episode')}: {at}."
    figures = profile_results(results, condition)
    late = [
        run
        for each in figures
        for run, episode in zip(each.runs, each.convergence_episodes, strict=True)
        if episode is None
    ]
    if late:
        at = _places([_run(run) for run in late])
        yield f"{under}{len(late)} of {_count(len(runs), 'run')} did not converge to d ≤ {CONVERGED_DISTANCE:g}: {at}."
    wrong = sum(len(each.runs) - (each.dominant_right or 0) for each in figures if each.dominant_right is not None)
    if wrong:
        in_runs = f"{wrong} of {_count(len(runs), 'run')}"
        yield f"{under}In {in_runs} the greatest weight is not what matters most to the patient."


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + "s" * (number != 1)


def _run(run: Run) -> str:
    return f"{words(run.profile)} seed {run.seed}"


def _places(places: Sequence[str]) -> str:
    more = len(places) - _MOST_NAMED
    return "; ".join(places[:_MOST_NAMED]) + (f"; and {more} more" if more > 0 else "")


def learning_sentences(results: Results) -> tuple[str, ...]:
    """How fast and how well the preferences were learned, beside the paper's learner and the paper's own figures."""
    sentences = []
    for condition in compared_conditions(results):
        figures = profile_results(results, condition)
        episodes = [each.convergence.median for each in figures]
        told = "no convergence" if min(episodes) == math.inf else f"convergence after {_episodes(_range(episodes, 1))}"
        finals = _range([each.final_distance.median for each in figures], 3)
        learner = words(results.learner(condition)).capitalize()
        text = f"{learner}: {told} and a final distance of {finals} (medians by patient)"
        ratio = final_error_over_bound(known_runs(results, condition), rating_noise(results, condition))
        sentences.append(text + ("." if ratio is None else f"; final error {ratio:.2f} times the information bound."))
    reported = [PAPER_RESULTS[profile] for profile in results.profiles if profile in PAPER_RESULTS]
    if reported:
        counted = _range([each.rated_episodes[0] for each in reported], 1)
        finals = _range([each.final_distance for each in reported], 3)
        sentences.append(f"The paper reports convergence after {_episodes(counted)} and final distances of {finals}.")
    return tuple(sentences)


def _episodes(count: str) -> str:
    return f"{count} rated episode" + "s" * (count != "1")


def _range(values: Sequence[float], digits: int) -> str:
    least, greatest = (number(value, digits).removesuffix(".0") for value in (min(values), max(values)))
    return least if least == greatest else f"{least} to {greatest}"


def plan_sentences(results: Results) -> tuple[str, ...]:
    """What was done most often for each patient."""
    sentences = []
    for each in profile_results(results, results.main):
        parts = []
        for task in results.tasks:
            counted = each.variants(task)
            if counted:
                variant, count = min(counted.items(), key=lambda item: (-item[1], item[0]))
                share = percent(count, counted.total())
                parts.append(f"{words(task)} mostly by {readable_variant(variant)} ({share})")
        if parts:
            sentences.append(f"{words(each.profile).capitalize()}: {'; '.join(parts)}.")
    return tuple(sentences)
