"""`mala-drake report`: every figure and table of an experiment, and one page that shows them all."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from mala_drake.errors import BadInput
from mala_drake.experiments.durable_files import writing
from mala_drake.experiments.episode_record import check_writable
from mala_drake.reporting.figures.bound import bound_picture
from mala_drake.reporting.figures.conditions import condition_picture
from mala_drake.reporting.figures.distances import distance_pictures
from mala_drake.reporting.figures.dynamics import dynamics_picture
from mala_drake.reporting.figures.features import feature_picture
from mala_drake.reporting.figures.floor_plan import floor_plan_pictures
from mala_drake.reporting.figures.mismatches import mismatch_picture
from mala_drake.reporting.figures.model_errors import model_error_picture
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.plans import meal_picture, variant_picture
from mala_drake.reporting.figures.prediction import prediction_picture
from mala_drake.reporting.figures.style import styled
from mala_drake.reporting.figures.target_distances import target_distance_picture
from mala_drake.reporting.figures.target_map import target_map_pictures
from mala_drake.reporting.figures.task_graphs import task_graph_pictures
from mala_drake.reporting.figures.translation import translation_picture
from mala_drake.reporting.figures.weight_factors import factor_picture
from mala_drake.reporting.figures.weights import final_weights_picture, trajectory_picture
from mala_drake.reporting.findings import headline, learning_sentences, plan_sentences, problems
from mala_drake.reporting.inner_loop_findings import inner_loop_sentences
from mala_drake.reporting.inner_loop_tables import action_table, dynamics_table
from mala_drake.reporting.report_page import Section, report_page
from mala_drake.reporting.result_tables import condition_table, convergence_table, execution_table, timing_table
from mala_drake.reporting.results import Results, load_results
from mala_drake.reporting.table import Table
from mala_drake.reporting.target_findings import target_headline, target_sentences
from mala_drake.reporting.target_results import has_targets
from mala_drake.reporting.target_sensitivities import sensitivity_sentences, sensitivity_table
from mala_drake.reporting.target_tables import target_condition_table, target_table
from mala_drake.reporting.wording import words
from mala_drake.ward.ward_map import LoadWard, Ward

PAGE = "report.html"
_FIGURES, _TABLES = "figures", "tables"  # Folders.
_TITLE = "Learning what the patient wants"
_TARGETS_TITLE = "Finding places that are not where the map says"


def write_report(folder: Path, out: Path | None = None) -> tuple[Path, ...]:
    """Writes the figures (PNG and PDF), the tables (Markdown and LaTeX) and the page of the results in a folder.

    The same results give the same bytes.

    Args:
        folder: as `run --out` or `experiment --out` has written it, or as much of it as there is.
        out: where the report goes; None is `report` in the folder.

    Returns:
        What was written, the page first.

    Raises:
        BadInput: when the folder holds no results, or a file cannot be written.
    """
    results = load_results(folder)
    out = folder / "report" if out is None else out
    check_writable(out / PAGE)
    for name in (_FIGURES, _TABLES):
        with writing(out / name):
            (out / name).mkdir(exist_ok=True)
    with styled():
        ward, notes = _ward(results)
        sections = tuple(_sections(results, ward))
        page = report_page(
            title=_TARGETS_TITLE if has_targets(results) else _TITLE,
            lead=_lead(results),
            headline=(*target_headline(results, ward), *headline(results)),
            problems=(*problems(results), *notes),
            sections=sections,
        )
        written = [path for item in _content(sections) for path in _write(item, out)]
    with writing(out / PAGE):
        (out / PAGE).write_text(page, encoding="utf-8")
    return (out / PAGE, *written)


def _sections(results: Results, ward: Ward) -> Iterator[Section]:
    if has_targets(results):
        yield Section(
            "targets",
            "Targets",
            (*target_sentences(results, ward), *sensitivity_sentences(results)),
            (
                *target_distance_picture(results, ward),
                target_table(results, ward),
                *target_map_pictures(results, ward),
                target_condition_table(results, ward),
                *sensitivity_table(results),
            ),
        )
    yield Section(
        "learning",
        "Learning",
        learning_sentences(results),
        (
            *distance_pictures(results),
            convergence_table(results),
            *trajectory_picture(results),
            *final_weights_picture(results),
            *bound_picture(results),
        ),
    )
    yield Section(
        "plans",
        "Plans",
        plan_sentences(results),
        (
            *variant_picture(results),
            *meal_picture(results),
            *floor_plan_pictures(results, ward),
            *feature_picture(results),
            *prediction_picture(results),
        ),
    )
    yield Section("inner_loop", "Inner loop", inner_loop_sentences(results), tuple(_inner_loop(results)))
    yield Section("tasks", "Tasks", (), tuple(task_graph_pictures(ward)))
    table = condition_table(results)
    if table:
        yield Section("conditions", "Conditions", (), (*condition_picture(results), table))
    times = timing_table(results)
    yield Section("execution", "Execution", (), (execution_table(results), *([times] if times else [])))


def _inner_loop(results: Results) -> Iterator[Picture | Table]:
    """What became of single actions, and what the controller learned from them."""
    actions, dynamics = action_table(results), dynamics_table(results)
    yield from mismatch_picture(results)
    yield from [actions] if actions else []
    yield from dynamics_picture(results)
    yield from [dynamics] if dynamics else []
    yield from model_error_picture(results)
    yield from factor_picture(results)
    yield from translation_picture(results)


def _lead(results: Results) -> str:
    runs = results.of(results.main)
    tasks = " and ".join(words(task) for task in results.tasks)
    lengths = sorted({len(run.episodes) for run in runs})
    episodes = f"{lengths[-1]}" if len(lengths) == 1 else f"{lengths[0]} to {lengths[-1]}"
    patients = f"{len(results.profiles)} patient{'s' * (len(results.profiles) != 1)}"
    return (
        f"{patients}, {len(runs)} run{'s' * (len(runs) != 1)} of {episodes} episodes each ({tasks}), "
        f"learner: {words(results.learner(results.main))}. Everything here is counted from the recorded episodes."
    )


def _ward(results: Results) -> tuple[Ward, tuple[str, ...]]:
    """The ward that was run in, and notes: when it cannot be read any more, it is the one of the package."""
    told = results.told(results.main, "ward")
    try:
        return LoadWard(str(told) if told else None), ()
    except BadInput as error:
        note = (
            f"The ward map {told} cannot be used ({error.what}): places, ways and distances to places are shown on the "
            "map that comes with the package, which is not the one that was run in."
        )
        return LoadWard(), (note,)


def _content(sections: Iterable[Section]) -> Iterator[Picture | Table]:
    return (item for section in sections for item in section.content)


def _write(item: Picture | Table, out: Path) -> Iterator[Path]:
    if isinstance(item, Picture):
        with writing(out / _FIGURES / item.name):
            yield from item.write(out / _FIGURES)
        return
    forms: tuple[tuple[str, Callable[[], str]], ...] = ((".md", item.to_markdown), (".tex", item.to_latex))
    for suffix, text in forms:
        path = out / _TABLES / (item.name + suffix)
        with writing(path):
            path.write_text(text(), encoding="utf-8")
        yield path
