"""The tables of a report: convergence beside the paper's, conditions beside each other, times."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.learning.convergence import CONVERGED_DISTANCE
from mala_drake.reporting.paper_results import PAPER_RESULTS, RUNS, PaperResults
from mala_drake.reporting.profile_results import ProfileResults, profile_results
from mala_drake.reporting.quantiles import Spread, quantile, spread
from mala_drake.reporting.results import Results
from mala_drake.reporting.table import Group, Row, Table
from mala_drake.reporting.wording import title_of, words

NONE = "–"
"""What a cell says when there is no figure."""

PAPERS_LEARNER = "projected_gradient"
"""The condition that stands beside the main one, since it is the learner of the paper."""

_MOST_COLUMNS = 3  # Patients that the table of conditions tells apart.

_HEADINGS = (
    "learner",
    "converged",
    "conv. ep.",
    "best d",
    "final d",
    "dominant",
    "plans",
    "success",
    "collisions",
)


def convergence_table(results: Results) -> Table:
    """Each patient under the main condition and under the paper's learner, and what the paper reports."""
    ours = [list(profile_results(results, condition)) for condition in compared_conditions(results)]
    groups = []
    for profile in results.profiles:
        rows = [_row(each, results) for figures in ours for each in figures if each.profile == profile]
        if profile in PAPER_RESULTS:
            rows.append(_paper_row(PAPER_RESULTS[profile]))
        groups.append(Group(tuple(rows), title_of(profile)))
    groups.append(Group(tuple(_total_row(figures, results) for figures in ours), "All"))
    caption = (
        f"Converged means d ≤ {CONVERGED_DISTANCE:g}, where d is the distance between learned and true weights. Conv. "
        "ep. is the number of rated episodes after which this first holds: median (quartiles); the paper counts "
        "from 0, and one is added to its figures. Best and final d: median (quartiles) over seeds; in the paper, mean "
        "± standard deviation, and mean. Dominant counts the runs in which the greatest weight is the right one. "
        "Plans counts the variants executed to their end; the paper's table and text differ."
    ) + changes_of_mind(results, compared_conditions(results))
    return Table("convergence", caption, _HEADINGS, tuple(groups))


def compared_conditions(results: Results) -> tuple[str, ...]:
    """The main condition, and the paper's learner where it is there and not the main one."""
    others = [PAPERS_LEARNER] if PAPERS_LEARNER in results.conditions and results.main != PAPERS_LEARNER else []
    return (results.main, *others)


def changes_of_mind(results: Results, conditions: Sequence[str]) -> str:
    """What a caption adds where patients change their minds: which figures are of the time since."""
    changing = [name for name in conditions if any(run.earlier_episodes for run in results.of(name))]
    if not changing:
        return ""
    under = " and ".join(words(results.learner(name)) for name in changing)
    return (
        f" Under {under} the patient changes its mind: convergence, distances and costs are counted from the first "
        "episode after that."
    )


def _row(figures: ProfileResults, results: Results) -> Row:
    right = figures.dominant_right
    return (
        words(results.learner(figures.condition)),
        f"{figures.converged}/{len(figures.runs)}",
        counts(figures.convergence),
        distances(figures.best_distance),
        distances(figures.final_distance),
        NONE if right is None else f"{right}/{len(figures.runs)}",
        str(len(figures.variants())),
        percent(figures.successes, figures.episodes),
        str(figures.collisions),
    )


def _paper_row(paper: PaperResults) -> Row:
    best, deviation = paper.best_distance
    by_table, by_text = paper.variants
    return (
        "paper",
        f"{RUNS}/{RUNS}",
        counts(Spread(*map(float, paper.rated_episodes))),
        f"{best:.3f} ± {deviation:.3f}",
        f"{paper.final_distance:.3f}",
        f"{RUNS}/{RUNS}",
        f"{by_table} or {by_text}",
        "100 %",
        NONE,
    )


def _total_row(figures: Sequence[ProfileResults], results: Results) -> Row:
    runs = sum(len(each.runs) for each in figures)
    known = [each for each in figures if each.dominant_right is not None]
    right = sum(each.dominant_right or 0 for each in known)
    distance = spread(run.learning.final_distance for each in figures for run in each.runs)
    return (
        words(results.learner(figures[0].condition)),
        f"{sum(each.converged for each in figures)}/{runs}",
        counts(_convergence(figures)),
        NONE,
        distances(distance),
        f"{right}/{sum(len(each.runs) for each in known)}" if known else NONE,
        NONE,
        percent(sum(each.successes for each in figures), sum(each.episodes for each in figures)),
        str(sum(each.collisions for each in figures)),
    )


def _convergence(figures: Iterable[ProfileResults]) -> Spread:
    episodes = [episode for each in figures for episode in each.convergence_episodes]
    return spread(math.inf if episode is None else float(episode) for episode in episodes)


def condition_table(results: Results) -> Table | None:
    """What each condition came to, over all its runs and by patient; None when there is but one condition."""
    if len(results.conditions) < 2:
        return None
    by_condition = {condition: profile_results(results, condition) for condition in results.conditions}
    profiles = list(dict.fromkeys(each.profile for figures in by_condition.values() for each in figures))
    told_apart = profiles if len(profiles) <= _MOST_COLUMNS else []  # The figure shows them all.
    headings = (
        "condition",
        "runs",
        "converged",
        "conv. ep.",
        "final d",
        *(f"final d, {words(profile)}" for profile in told_apart),
        "plans",
        "cost",
        "success",
        "collisions",
    )
    rows = []
    for condition, figures in by_condition.items():
        of_profile = {each.profile: each for each in figures}
        runs = sum(len(each.runs) for each in figures)
        rows.append(
            (
                words(results.learner(condition)),
                str(runs),
                f"{sum(each.converged for each in figures)}/{runs}",
                counts(_convergence(figures)),
                distances(spread(run.learning.final_distance for each in figures for run in each.runs)),
                *(
                    number(of_profile[profile].final_distance.median, 3) if profile in of_profile else NONE
                    for profile in told_apart
                ),
                str(len({variant for each in figures for variant in each.variants()})),
                number(quantile((each.cost.median for each in figures), 0.5), 3),
                percent(sum(each.successes for each in figures), sum(each.episodes for each in figures)),
                str(sum(each.collisions for each in figures)),
            )
        )
    caption = (
        "Each condition over all its runs: medians (quartiles), final d by patient as medians. Cost is w*·f, the true "
        "weights on the measured features, of an average episode in which the task was done: the median over patients "
        "of the median over seeds."
    ) + changes_of_mind(results, results.conditions)
    return Table("conditions", caption, headings, (Group(tuple(rows[:1])), Group(tuple(rows[1:]))))


def execution_table(results: Results) -> Table:
    """How each condition was driven: the worst of all its episodes."""
    headings = (
        "condition",
        "episodes",
        "clearance, m",
        "stop, m",
        "stop, rad",
        "stop, m/s",
        "solves",
        "failed",
        "stopped early",
        "mismatches",
        "hours",
    )
    rows = []
    for condition in results.conditions:
        records = [record for run in results.of(condition) for record in run.episodes]
        rows.append(
            (
                words(results.learner(condition)),
                str(len(records)),
                number(quantile((record.min_clearance_m for record in records), 0.0), 3),
                number(_worst(record.terminal_errors_m for record in records), 3),
                number(_worst(record.terminal_yaw_errors_rad for record in records), 3),
                number(_worst(record.terminal_speeds_m_s for record in records), 3),
                str(sum(record.mpc_solves for record in records)),
                str(sum(record.mpc_failures for record in records)),
                _stopped_early(records),
                str(sum(record.mismatches for record in records)),
                f"{sum(record.sim_time_s for record in records) / 3600:.1f}",
            )
        )
    caption = (
        "The worst of all episodes: least clearance of the robot's body to anything solid, taken at every plant step; "
        "greatest distance, angle and speed with which a leg ended. In all: solves of the MPC, how many failed, and "
        "how many stopped at the iteration limit and were driven with; actions after which the symbolic state was not "
        "the expected one; hours of simulation."
    )
    return Table("execution", caption, headings, (Group(tuple(rows)),))


def _stopped_early(records: Iterable[EpisodeRecord]) -> str:
    """How many solves stopped early, where the episodes tell it apart from failures."""
    told = [record.mpc_not_converged for record in records if record.mpc_not_converged is not None]
    return str(sum(told)) if told else NONE


def _worst(values: Iterable[Sequence[float | None]]) -> float:
    return quantile((abs(value) for of_episode in values for value in of_episode if value is not None), 1.0)


def timing_table(results: Results) -> Table | None:
    """What the main condition took to compute; None when the episodes do not tell."""
    by_key: dict[str, list[float]] = {}
    for run in results.of(results.main):
        for record in run.episodes:
            for key, value in record.timing.items():
                by_key.setdefault(key, []).append(value)
    if not by_key:
        return None
    rows = []
    for key, values in by_key.items():
        figures = spread(values)
        name, unit = key.rsplit("_", 1)
        texts = (f"{value:.3g}" for value in (figures.median, figures.lower, figures.upper, max(values)))
        rows.append((f"{words(name)}, {unit} an episode" if unit == "s" else f"{words(name)}, {unit}", *texts))
    caption = "Over the episodes of the main condition. Times depend on the machine and on what else it was doing."
    return Table(
        "timing", caption, ("time", "median", "lower quartile", "upper quartile", "greatest"), (Group(tuple(rows)),)
    )


def number(value: float, digits: int) -> str:
    """A figure with this many decimals; infinite ones are never reached, NaN is none."""
    if math.isnan(value):
        return NONE
    return "never" if math.isinf(value) else f"{value:.{digits}f}"


def counts(figures: Spread) -> str:
    """Median and quartiles of counts, with a decimal only where there is something behind it."""
    median, lower, upper = (
        number(value, 1).removesuffix(".0") for value in (figures.median, figures.lower, figures.upper)
    )
    return median if lower == upper else f"{median} ({lower}–{upper})"


def distances(figures: Spread) -> str:
    """Median and quartiles of distances."""
    median, lower, upper = (number(value, 3) for value in (figures.median, figures.lower, figures.upper))
    return median if lower == upper else f"{median} ({lower}–{upper})"


def percent(part: int, whole: int) -> str:
    """A share, rounded down to a tenth so that only all is 100 %."""
    return f"{math.floor(1000 * part / whole) / 10:g} %"
