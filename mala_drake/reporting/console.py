"""What a run looks like on a terminal: progress while it works, a readable summary at the end."""

from __future__ import annotations

from collections.abc import Sequence
from types import TracebackType
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.preferences import CRITERIA
from mala_drake.scenario import Scenario


class RunConsole:
    """Shows a run as it goes, on standard error, and its summary, on standard output."""

    def __init__(self, scenario: Scenario, *, quiet: bool) -> None:
        """Shows `scenario`; quiet leaves nothing but what the caller prints itself."""
        self._scenario = scenario
        self._errors = Console(stderr=True, quiet=quiet)
        self._output = Console(quiet=quiet)
        self._progress = Progress(
            SpinnerColumn(),
            BarColumn(bar_width=20),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.description}"),
            console=self._errors,
            transient=True,
        )
        self._bar = self._progress.add_task("starting", total=scenario.episodes)

    def __enter__(self) -> RunConsole:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._progress.stop()

    def on_action(self, episode: int, seconds: float, text: str) -> None:
        """Shows what the robot does now."""
        self._progress.update(self._bar, description=f"episode {episode + 1}, {seconds:5.1f} s: {text}")

    def on_episode(self, record: EpisodeRecord) -> None:
        """Prints a line for an episode that has ended."""
        self._progress.advance(self._bar)
        verdict = "[green]delivered[/]" if record.success else f"[red]failed: {record.failure}[/]"
        self._errors.print(
            f"episode {record.episode + 1}: {verdict} in {record.sim_time_s:.1f} s by {record.plan_variant}, "
            f"clearance {record.min_clearance_m:.2f} m, distance to true preferences {record.distance_to_true:.3f} "
            f"[dim]({record.timing['wall_s']:.1f} s of computing)[/]"
        )

    def show(self, summary: dict[str, Any]) -> None:
        """Prints the summary of a run."""
        self._progress.stop()
        totals, timing = summary["totals"], summary["timing"]
        for name, figures in summary["profiles"].items():
            table = Table(title=f"{self._scenario.task}, patient {name}", show_header=False, title_justify="left")
            table.add_row("episodes delivered", f"{totals['successes']} of {totals['episodes']}")
            table.add_row("collisions", str(totals["collisions"]))
            table.add_row("least clearance of the body", f"{totals['min_clearance_m']:.3f} m")
            if totals["max_terminal_error_m"] is not None:
                worst = f"{totals['max_terminal_error_m']:.3f} m, {totals['max_terminal_yaw_error_rad']:.3f} rad"
                table.add_row("worst stop of a leg", f"{worst}, {totals['max_terminal_speed_m_s']:.3f} m/s")
            table.add_row("plans", ", ".join(figures["plan_variants"]) or "none")
            table.add_row("distance to true preferences", f"{figures['final_distance']:.3f} (last episode)")
            table.add_row("MPC solves", f"{totals['mpc_solves']}, {totals['mpc_failures']} failed")
            table.add_row("median time of a solve", f"{timing['mpc_median_ms']:.1f} ms")
            table.add_row("median time of an episode", f"{timing['median_episode_wall_s']:.1f} s")
            self._output.print(table)

    def tell(self, text: str) -> None:
        """Prints a line of plain text."""
        self._output.print(text, highlight=False, soft_wrap=True)


def weights_table(estimate: Sequence[float], true: Sequence[float]) -> Table:
    """Learned against true preference weights."""
    table = Table("criterion", "learned", "true")
    for criterion, learned, wanted in zip(CRITERIA, estimate, true, strict=True):
        table.add_row(criterion, f"{learned:.2f}", f"{wanted:.2f}")
    return table


def print_rows(title: str, rows: Sequence[dict[str, Any]]) -> None:
    """Prints benchmark rows as a table; every row has the same keys."""
    table = Table(title=title, title_justify="left")
    for key in rows[0] if rows else ():
        table.add_column(key, justify="left" if isinstance(rows[0][key], str) else "right")
    for row in rows:
        table.add_row(*(f"{value:.3g}" if isinstance(value, float) else str(value) for value in row.values()))
    Console().print(table)
