"""What a run looks like on a terminal: progress while it works, a readable summary at the end."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from mala_drake.experiments.episode_record import EpisodeRecord
from mala_drake.preferences import CRITERIA
from mala_drake.reporting.progress_console import ProgressConsole
from mala_drake.scenario import Scenario


class RunConsole(ProgressConsole):
    """Shows a run as it goes, on standard error, and its summary, on standard output."""

    def __init__(self, scenario: Scenario, *, quiet: bool) -> None:
        """Shows `scenario`; quiet leaves nothing but what the caller prints itself."""
        self._scenario = scenario
        self._last: EpisodeRecord | None = None
        super().__init__(
            SpinnerColumn(),
            BarColumn(bar_width=20),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.description}", markup=False),
            quiet=quiet,
        )
        self._bar = self._progress.add_task("starting", total=scenario.episodes)

    def on_action(self, episode: int, seconds: float, text: str) -> None:
        """Shows what the robot does now."""
        self._progress.update(self._bar, description=f"episode {episode + 1}, {seconds:5.1f} s: {text}")

    def on_episode(self, record: EpisodeRecord) -> None:
        """Prints a line for an episode that has ended."""
        self._last = record
        self._progress.advance(self._bar)
        # Assembled, not marked up: a failure may have brackets of its own.
        line = Text.assemble(
            f"episode {record.episode + 1}: ",
            ("delivered", "green") if record.success else (f"failed: {record.failure}", "red"),
            f", {record.sim_time_s:.1f} s by {record.plan_variant}, clearance {_number(record.min_clearance_m, 2)} m, "
            f"preferences off by {record.distance_to_true:.3f} ",
            (f"(computed in {record.timing['wall_s']:.1f} s)", "dim"),
        )
        self._errors.print(line, soft_wrap=True)

    def show(self, summary: dict[str, Any]) -> None:
        """Prints the summary of a run: its figures, the last episode's actions, and what has been learned."""
        self._progress.stop()
        for name, figures in summary["profiles"].items():
            title = f"{self._scenario.task}, patient {name.replace('_', ' ')}"
            self._output.print(_figures_table(title, summary["totals"], summary["timing"], figures))
        if self._last is not None:
            self._output.print(f"Executed in episode {self._last.episode + 1}:", highlight=False)
            self._output.print("  " + " → ".join(map(_words, self._last.actions)), highlight=False, markup=False)
            self._output.print(weights_table(self._last, self._scenario.true_weights))


def _figures_table(title: str, totals: dict[str, Any], timing: dict[str, Any], figures: dict[str, Any]) -> Table:
    table = Table(title=title, show_header=False, title_justify="left")
    table.add_row("episodes delivered", f"{totals['successes']} of {totals['episodes']}")
    for failure, count in Counter(totals["failures"]).items():
        table.add_row("failed", Text(f"{count} x {failure}"))
    table.add_row("collisions", str(totals["collisions"]))
    table.add_row("least clearance of the body", f"{_number(totals['min_clearance_m'], 3)} m")
    if totals["max_terminal_error_m"] is not None:
        worst = f"{totals['max_terminal_error_m']:.3f} m, {totals['max_terminal_yaw_error_rad']:.3f} rad"
        table.add_row("worst end of a leg", f"{worst}, {totals['max_terminal_speed_m_s']:.3f} m/s")
    table.add_row("plans that delivered", "\n".join(figures["plan_variants"]) or "none")
    table.add_row("rated episodes to convergence", str(figures["convergence_episode"] or "not yet converged"))
    final, best = (_number(figures[name], 3) for name in ("final_distance", "best_distance"))
    table.add_row("distance to true preferences", f"{final} (best {best})")
    stopped = f", {n} stopped early" if (n := totals["mpc_not_converged"]) else ""
    table.add_row("MPC solves", f"{totals['mpc_solves']}, {totals['mpc_failures']} failed{stopped}")
    table.add_row("median time of a solve", f"{timing['mpc_median_ms']:.1f} ms")
    table.add_row("median time of an episode", f"{timing['median_episode_wall_s']:.1f} s")
    return table


def weights_table(record: EpisodeRecord, true_weights: Sequence[float]) -> Table:
    """Learned against true preference weights, with the features and ratings of the episode learned from last."""
    table = Table("criterion", title="preferences", title_justify="left")
    for heading in ("learned", "true", "feature", "rating"):
        table.add_column(heading, justify="right")
    rows = zip(CRITERIA, record.weights_after, true_weights, record.ratings, strict=True)
    for criterion, learned, wanted, rating in rows:
        feature, given = record.features[criterion], "-" if rating is None else f"{rating:.2f}"
        table.add_row(criterion, f"{learned:.3f}", f"{wanted:.3f}", f"{feature:.3f}", given)
    return table


def _words(action: str) -> str:
    """A PDDL action for people: `(go_to_supply_a robot1 home supply_a)` is `go to supply a`."""
    return action.strip("()").split()[0].replace("_", " ")


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None or not math.isfinite(value) else f"{value:.{digits}f}"


def print_rows(title: str, rows: Sequence[dict[str, Any]]) -> None:
    """Prints benchmark rows as a table; every row has the same keys. A table too wide for the terminal is turned."""
    console = Console()
    names = list(rows[0]) if rows else []
    lines = [names, *([_cell(value) for value in row.values()] for row in rows)]
    columns = list(zip(*lines, strict=True))
    if _width(columns) <= console.width:
        words = [name for name in names if isinstance(rows[0][name], str)]
        _print_columns(console, title, columns, left=words)
        return
    # Turned: the keys to the left, and as many rows beside them as there is room for.
    keys, *turned = lines
    while turned:
        count = next((n for n in range(len(turned), 1, -1) if _width([keys, *turned[:n]]) <= console.width), 1)
        _print_columns(console, title, [keys, *turned[:count]], left=keys[:1])
        turned = turned[count:]


def _cell(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def _width(columns: Sequence[Sequence[str]]) -> int:
    """Characters of a table of these columns, with its lines."""
    return sum(max(map(len, column)) + 3 for column in columns) + 1


def _print_columns(console: Console, title: str, columns: Sequence[Sequence[str]], *, left: Sequence[str]) -> None:
    table = Table(title=title, title_justify="left")
    for heading, *_ in columns:
        table.add_column(heading, justify="left" if heading in left else "right")
    for line in list(zip(*columns, strict=True))[1:]:
        table.add_row(*line)
    console.print(table)
