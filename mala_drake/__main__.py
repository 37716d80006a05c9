"""Runs the command line with `python -m mala_drake`."""

from mala_drake.cli import main

main()
