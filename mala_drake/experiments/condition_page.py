"""The table of an experiment's conditions as a page of Markdown, with what each of them means."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from mala_drake.experiments.durable_files import replace_durably
from mala_drake.reporting.result_tables import condition_table
from mala_drake.reporting.results import load_results


def page_of(folder: Path, name: str) -> Path:
    """Where the page of the experiment `name` is."""
    return folder / f"{name}.md"


def write_condition_page(folder: Path, name: str, explanations: Mapping[str, str]) -> None:
    """Writes the page; without a table as long as there is but one condition to be told about.

    Args:
        folder: of an experiment's results, with its summary.
        name: of the experiment.
        explanations: what each condition means, by its name.
    """
    results = load_results(folder)
    table = condition_table(results)
    lines = [f"# {name.capitalize()}", "", *([table.to_markdown()] if table else [])]
    lines += [f"- **{_words(condition)}**: {explanations[condition]}." for condition in results.conditions]
    lines += ["", *(f"- {note}" for note in results.notes)]
    replace_durably(page_of(folder, name), "\n".join(lines).rstrip() + "\n")


def _words(condition: str) -> str:
    return condition.replace("_", " ")
