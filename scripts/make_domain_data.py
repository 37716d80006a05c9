"""Writes the numbers that follow from the ward into the planning problems in `domains/`.

Run it after a change of the map, of the drive paths or of the features; a test fails as long as they differ.
"""

from __future__ import annotations

from mala_drake.planning.features import write_problem
from mala_drake.resources import domains_folder
from mala_drake.ward.ward_map import LoadWard

PROBLEMS = {"medication": "problem_med.pddl", "meal": "problem_meal.pddl"}


def main() -> None:
    ward = LoadWard()
    for task, file in PROBLEMS.items():
        changed = write_problem(domains_folder() / file, ward, task)
        print(f"{file}: {'written' if changed else 'up to date'}")


if __name__ == "__main__":
    main()
