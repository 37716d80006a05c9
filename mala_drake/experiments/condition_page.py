"""The table of an experiment's conditions as a page of Markdown, with what each of them means."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mala_drake.experiments.durable_files import replace_durably
from mala_drake.experiments.experiment import Experiment
from mala_drake.reporting.result_tables import condition_table
from mala_drake.reporting.results import load_results


def page_of(folder: Path, name: str) -> Path:
    """Where the page of the experiment `name` is."""
    return folder / f"{name}.md"


def write_condition_page(folder: Path, experiment: Experiment, explanations: Mapping[str, str]) -> None:
    """Writes the page; without a table as long as there is but one condition to be told about.

    Args:
        folder: of the experiment's results, with its summary; what else is in it is passed over.
        experiment: that was run.
        explanations: what each condition means, by its name.

    Raises:
        BadInput: when no run has an episode, or a run's file cannot be read.
    """
    results = load_results(folder, only=experiment.runs)
    table = condition_table(results)
    lines = [f"# {experiment.name.capitalize()}", "", *([table.to_markdown()] if table else [])]
    lines += [f"- **{_words(condition)}**: {explanations[condition]}." for condition in results.conditions]
    lines += ["", *(f"- {note}" for note in results.notes)]
    replace_durably(page_of(folder, experiment.name), "\n".join(lines).rstrip() + "\n")


def _words(condition: str) -> str:
    return condition.replace("_", " ")
