"""A terminal on which something is computed for a while: a bar as it goes, and the results at the end."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import Progress, ProgressColumn


class ProgressConsole:
    """Shows progress and incidents on standard error, where nobody parses them, and results on standard output.

    The bar is there between entering and leaving, or until the results are shown. In a file or a pipe there is none.
    """

    def __init__(self, *columns: ProgressColumn, quiet: bool, speed_window: float = 30.0) -> None:
        """A bar of such columns.

        Args:
            columns: of the bar.
            quiet: leaves nothing but what the caller prints itself.
            speed_window: seconds over which the speed is averaged that a time left is told from.
        """
        self._errors = Console(stderr=True, quiet=quiet)
        self._output = Console(quiet=quiet)
        self._progress = Progress(
            *columns,
            console=self._errors,
            transient=True,
            speed_estimate_period=speed_window,
            disable=not self._errors.is_terminal,  # The lines that are printed on the way say enough.
        )

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._progress.stop()

    def show_files(self, paths: Iterable[Path]) -> None:
        """Prints where the files of the results are."""
        for path in paths:
            self._output.print(f"wrote {path}", markup=False, highlight=False, soft_wrap=True)
