"""What an experiment looks like on a terminal: a bar with the time left, a line a finished run, a table at the end."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.experiments.experiment import MAIN, RunName
from mala_drake.experiments.learning_figures import learning_figures
from mala_drake.reporting.progress_console import ProgressConsole

_SPEED_WINDOW = 1800.0  # Seconds over which the speed is averaged that the time left is told from.


class ExperimentConsole(ProgressConsole):
    """Shows an experiment as it goes, on standard error, and its summary, on standard output."""

    def __init__(self, *, quiet: bool) -> None:
        """Quiet leaves nothing but what the caller prints itself."""
        super().__init__(
            TextColumn("episodes"),
            BarColumn(bar_width=30),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("elapsed,"),
            TimeRemainingColumn(),
            TextColumn("left"),
            quiet=quiet,
            speed_window=_SPEED_WINDOW,
        )
        self._bar = self._progress.add_task("", total=None)

    def on_nothing_begun(self, folder: Path) -> None:
        """Says that what was meant to go on begins anew: the folder's name may be a slip of the hand."""
        self._errors.print(
            f"nothing was begun in {folder}: the experiment begins anew", markup=False, highlight=False, soft_wrap=True
        )

    def on_start(self, *, runs: int, episodes: int, done: int) -> None:
        """Says how much there is to do."""
        self._progress.update(self._bar, total=episodes, completed=done)
        before = f", of which {done} are there already" if done else ""
        self._errors.print(f"{runs} runs, {episodes} episodes{before}", highlight=False)

    def on_episode(self, run: RunName, episode: int) -> None:  # noqa: ARG002 (the contract has it)
        """Moves the bar."""
        self._progress.advance(self._bar)

    def on_run(self, run: RunName, records: Sequence[EpisodeRecord], *, earlier_episodes: int) -> None:
        """Prints a line for a run that has come to its end."""
        converged = learning_figures(records, earlier_episodes=earlier_episodes).convergence_episode
        delivered = sum(record.success for record in records)
        line = Text.assemble(
            f"{run}: ",
            (f"{delivered} of {len(records)} delivered", "green" if delivered == len(records) else "red"),
            f", {'converged after ' + str(converged) if converged else 'not converged'}, "
            f"preferences off by {records[-1].distance_to_true:.3f}, {sum(record.collisions for record in records)} "
            "collisions ",
            (f"(computed in {sum(record.timing['wall_s'] for record in records):.0f} s)", "dim"),
        )
        self._errors.print(line, soft_wrap=True)

    def on_failure(self, run: RunName, error: str) -> None:
        """Says which run has failed, and why."""
        self._errors.print(Text.assemble(f"{run}: ", (f"failed in {error}", "red")), soft_wrap=True)

    def show(self, summary: dict[str, Any]) -> None:
        """Prints the figures of each condition and patient."""
        self._progress.stop()
        table = Table(title=summary["experiment"], title_justify="left", box=SIMPLE_HEAD, padding=0, show_edge=False)
        table.add_column("patient", no_wrap=True)
        for heading in ("converged", "after", "final d", "dominant", "plans", "delivered", "hits"):
            table.add_column(heading, justify="right", no_wrap=True)
        main = {summary["scenario"]["learner"]["name"]: summary} if summary["condition"] == MAIN else {}
        for condition, results in {**main, **summary["conditions"]}.items():
            table.add_row(Text(condition, "bold"))
            for profile, figures in results["profiles"].items():
                table.add_row(f" {profile}", *_cells(figures))
            table.add_section()
        self._output.print(table)
        for run, error in summary["unfinished"].items():
            self._output.print(Text(f"unfinished: {run} (failed in {error})", "red"), soft_wrap=True)


def _cells(figures: dict[str, Any]) -> tuple[str, ...]:
    """What one patient's runs came to; "after" is the median of the rated episodes to convergence."""
    right = figures["dominant_right"]
    return (
        f"{figures['converged']}/{figures['runs']}",
        "never" if figures["convergence_episode"] is None else f"{figures['convergence_episode']:g}",
        "-" if figures["final_distance"] is None else f"{figures['final_distance']:.3f}",
        "-" if right is None else f"{right}/{figures['runs']}",
        str(len(figures["plan_variants"])),
        f"{figures['successes']}/{figures['episodes']}",
        str(figures["collisions"]),
    )
