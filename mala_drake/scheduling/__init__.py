"""The slow time scale: which task runs when."""

from mala_drake.scheduling.scheduler import Scheduler
from mala_drake.scheduling.sequence import Progress, advance, task_names

__all__ = ["Progress", "Scheduler", "advance", "task_names"]
