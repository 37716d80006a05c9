"""The command line: `mala-drake`. Thin: each command reads its options, calls the library and prints.

Heavy imports happen inside the commands, so that `--help` is quick. Exit status: 0 on success, 1 when the work itself
failed (an episode failed, no plan exists, time ran out), 2 on bad input, told in one line on standard error.
"""

from __future__ import annotations

import json
import logging
import math
import sys
from collections.abc import Sequence
from decimal import Decimal
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer

from mala_drake import __version__
from mala_drake.cli_options import chosen_scenario, names_of, search_of, seeds_of, weights_of
from mala_drake.errors import BadInput

app = typer.Typer(
    name="mala-drake",
    help="A care robot that schedules, plans, drives and learns, as one Drake systems diagram.",
    add_completion=False,
    pretty_exceptions_enable=False,
)

ScenarioFile = Annotated[Path | None, typer.Argument(help="Scenario file; the default scenario if left out.")]

# Click's UsageError: typer exports its subclass only, and brings a click of its own or uses the installed one.
_USAGE_ERROR: type[BaseException] = typer.BadParameter.__mro__[1]

_WEIGHT_FLUENTS = ("(w0)", "(w1)", "(w2)", "(w3)", "(w4)")

_INTERRUPTED = 130  # What a shell calls a program ended by Control-C.


@app.callback(invoke_without_command=True)
def start(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
) -> None:
    """A care robot that schedules, plans, drives and learns, as one Drake systems diagram."""
    if version:
        typer.echo(f"mala-drake {__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command()
def run(
    scenario: ScenarioFile = None,
    task: Annotated[str | None, typer.Option(help="What every episode is: medication, meal or alternate.")] = None,
    profile: Annotated[str | None, typer.Option(help="Patient profile, for example safety_first.")] = None,
    episodes: Annotated[int | None, typer.Option(help="Number of episodes.")] = None,
    seed: Annotated[int | None, typer.Option(help="Random seed.")] = None,
    solver: Annotated[str | None, typer.Option(help="MPC solver: snopt, ipopt or rti.")] = None,
    out: Annotated[
        Path, typer.Option(help="Folder for episodes.jsonl and summary.json; those of an earlier run are replaced.")
    ] = Path("results"),
    html: Annotated[Path | None, typer.Option(help="Write a self-contained 3-D recording here.")] = None,
    realtime_rate: Annotated[float, typer.Option(help="Simulation speed; 0 is as fast as possible.")] = 0.0,
    meshcat: Annotated[bool, typer.Option("--meshcat", help="Show the run live in the browser.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON and nothing else.")] = False,
) -> None:
    """Simulate the closed loop: schedule, plan, drive, deliver, be rated, learn.

    Each episode is written as soon as it has ended; what is written stays when the run is interrupted.
    """
    if not (math.isfinite(realtime_rate) and realtime_rate >= 0.0):
        raise BadInput("--realtime-rate", str(realtime_rate), "a finite number >= 0")
    from mala_drake.experiments.run import RunOptions, run_scenario
    from mala_drake.reporting.console import RunConsole

    chosen = chosen_scenario(scenario, task, profile, episodes, seed, solver)
    options = RunOptions(out=out, html=html, realtime_rate=realtime_rate, live=meshcat)
    with RunConsole(chosen, quiet=as_json) as console:
        summary = run_scenario(chosen, options, watcher=console)
    if as_json:
        typer.echo(json.dumps(summary))
    else:
        console.show(summary)
        console.show_files(options.files)
    raise typer.Exit(0 if summary["totals"]["successes"] == summary["totals"]["episodes"] else 1)


@app.command()
def plan(
    domain: Annotated[Path, typer.Argument(help="PDDL domain file.")],
    problem: Annotated[Path, typer.Argument(help="PDDL problem file.")],
    weights: Annotated[str | None, typer.Option(help="Five numbers w0,w1,w2,w3,w4.")] = None,
    timeout: Annotated[float | None, typer.Option(help="Seconds after which to give up.")] = None,
    search: Annotated[str, typer.Option(help="astar, or ucs (blind uniform-cost search).")] = "astar",
    as_json: Annotated[bool, typer.Option("--json", help="Print the plan as JSON and nothing else.")] = False,
) -> None:
    """Solve a PDDL task to optimality."""
    values = weights_of(weights)
    if timeout is not None and not (math.isfinite(timeout) and timeout > 0):
        raise BadInput("--timeout", str(timeout), "a positive number of seconds")
    chosen = search_of(search)
    from mala_drake.planning import plan_to_json, solve_files

    try:
        found = solve_files(domain, problem, weights=values, timeout=timeout, search=chosen)
    except BadInput as error:
        if values is not None and error.where in _WEIGHT_FLUENTS:
            what = f"{domain} declares no fluent {error.where}"
            raise BadInput("--weights", what, "a domain with " + " ".join(_WEIGHT_FLUENTS)) from None
        raise
    result = plan_to_json(found)
    if as_json:
        try:
            typer.echo(json.dumps(result))
        except ValueError:
            digits = sys.get_int_max_str_digits()
            raise BadInput(f"{problem}: :metric", f"a cost with more than {digits} digits", "smaller numbers") from None
    else:
        _print_plan(result)
    raise typer.Exit(0 if result["status"] == "optimal" else 1)


def _print_plan(result: dict[str, Any]) -> None:
    for step, action in enumerate(result["actions"], start=1):
        typer.echo(f"{step:3d}  {action}")
    cost = "" if result["cost"] is None else f", cost {_rounded(result['cost'])}"
    times = (
        f"read {result['parse_ms']:.0f} ms, ground {result['ground_ms']:.0f} ms, search {result['search_ms']:.1f} ms"
    )
    typer.echo(f"{result['status']}{cost}; {result['expanded']} expanded; {times}")


def _rounded(number: float) -> str:
    try:
        return f"{number:g}"
    except OverflowError:  # A whole number beyond all floats.
        return f"{Decimal(number):.5e}"


@app.command()
def graph(
    scenario: ScenarioFile = None,
    out: Annotated[Path, typer.Option(help="File to write: .dot, .md (Mermaid), .svg or .png.")] = Path("diagram.md"),
    max_depth: Annotated[int | None, typer.Option(help="Levels of nested diagrams to open.")] = None,
) -> None:
    """Draw the diagram of a scenario."""
    from mala_drake.reporting.diagram_graph import write_graph
    from mala_drake.scenario import LoadScenario
    from mala_drake.station import MakeCareStation

    if max_depth is not None and max_depth < 0:
        raise BadInput("--max-depth", str(max_depth), "a whole number >= 0")
    write_graph(MakeCareStation(LoadScenario(scenario)), out, max_depth=max_depth)
    typer.echo(f"wrote {out}")


@app.command()
def experiment(
    name: Annotated[str, typer.Argument(help="convergence, ablations or targets.")],
    scenario: Annotated[
        Path | None, typer.Argument(help="Scenario file that the runs are based on; the usual scenario if left out.")
    ] = None,
    profiles: Annotated[
        str | None,
        typer.Option(
            help="Patient profiles, separated by commas; left out: 5 for convergence, 2 for ablations, 1 for targets."
        ),
    ] = None,
    seeds: Annotated[str | None, typer.Option(help="Random seeds, for example 0,1,7 or 0-4, which is usual.")] = None,
    episodes: Annotated[
        int | None,
        typer.Option(
            help="Number of episodes of each run; left out: 40 for convergence, 20 for ablations, 6 for targets."
        ),
    ] = None,
    learners: Annotated[
        str | None,
        typer.Option(help="Of convergence: preference learners, separated by commas; the first is the main one."),
    ] = None,
    conditions: Annotated[
        str | None,
        typer.Option(help="Of ablations and targets: conditions, separated by commas; all of them if left out."),
    ] = None,
    full: Annotated[
        bool, typer.Option("--full", help="Of ablations: all 5 patients, and 40 episodes of each run.")
    ] = False,
    task: Annotated[str | None, typer.Option(help="medication, meal or alternate, which is usual.")] = None,
    solver: Annotated[str | None, typer.Option(help="MPC solver: snopt, ipopt or rti.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder of the results; results/NAME if left out.")] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with what was begun in the folder, or begin there.")
    ] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace what was begun in the folder.")] = False,
    jobs: Annotated[
        int | None, typer.Option(help="Episodes at a time; as many as there are cores if left out.")
    ] = None,
    executor: Annotated[str, typer.Option(help="Where to compute: processes, serial or dask.")] = "processes",
    address: Annotated[str | None, typer.Option(help="Of dask: address of the scheduler, tcp://HOST:PORT.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON and nothing else.")] = False,
) -> None:
    """Run an experiment of the paper: many patients and seeds, side by side.

    Each episode is written as soon as it has ended. However a run ends, `--resume` goes on where it was, with the same
    results as if it had never stopped; options that are left out are then those it was begun with.
    """
    from mala_drake.experiments.experiment_kind import ExperimentOptions
    from mala_drake.experiments.experiments import Execution, experiment_kind, files_of, run_experiment
    from mala_drake.reporting.experiment_console import ExperimentConsole

    if resume and overwrite:
        raise BadInput("--resume", "together with --overwrite", "one of them")
    kind = experiment_kind(name)
    chosen = {"--learners": learners, "--conditions": conditions}
    for option, text in chosen.items():
        if text is not None and option != kind.condition_option:
            raise BadInput(option, f"with {name}", f"{kind.condition_option}, or nothing")
    options = ExperimentOptions(
        scenario=scenario,
        profiles=names_of("--profiles", profiles),
        seeds=seeds_of(seeds),
        episodes=episodes,
        conditions=names_of(kind.condition_option, chosen[kind.condition_option]),
        full=full,
        task=task,
        solver=solver,
    )
    folder = out or Path("results") / name
    execution = Execution(out=folder, resume=resume, overwrite=overwrite, executor=executor, jobs=jobs, address=address)
    with ExperimentConsole(quiet=as_json) as console:
        summary = run_experiment(kind, options, execution, watcher=console)
    if as_json:
        typer.echo(json.dumps(summary))
    else:
        console.show(summary)
        console.show_files(files_of(kind, folder))
    raise typer.Exit(0 if _all_done(summary) else 1)


def _all_done(summary: dict[str, Any]) -> bool:
    every = [summary, *summary["conditions"].values()]
    delivered = all(each["totals"]["successes"] == each["totals"]["episodes"] for each in every)
    return delivered and not summary["unfinished"]


@app.command()
def report(
    folder: Annotated[Path, typer.Argument(help="Results of `experiment --out` or `run --out`.")],
    out: Annotated[Path | None, typer.Option(help="Folder of the report; `report` in the results if left out.")] = None,
) -> None:
    """Make all figures and tables of an experiment, and one page that shows them."""
    from mala_drake.reporting.report import write_report

    written = write_report(folder, out)
    typer.echo(f"wrote {written[0]}, and {len(written) - 1} figures and tables beside it")


@app.command()
def bench(
    name: Annotated[
        str | None, typer.Argument(help="plant, mpc, agreement, plan, episode or sensitivities; all if left out.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the rows as JSON and nothing else.")] = False,
) -> None:
    """Run the benchmarks and print a table."""
    from mala_drake.experiments.bench import run_benchmarks
    from mala_drake.reporting.console import print_rows

    # IPOPT says a line for every solve that it gives up; the tables count them.
    logging.getLogger("drake").addFilter(lambda record: not record.getMessage().startswith("IPOPT terminated"))
    results = run_benchmarks(name)
    if as_json:
        typer.echo(json.dumps(results))
        return
    for title, rows in results.items():
        print_rows(title, rows)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Runs the command line and ends the process, with every mistake of the user told in one line.

    Args:
        arguments: of the command line; None for those of the process.
    """
    try:
        status = app(args=None if arguments is None else list(arguments), prog_name="mala-drake", standalone_mode=False)
    except BadInput as error:
        _end(str(error), 2)
    except _USAGE_ERROR as error:
        _end(_usage(error), 2)
    except (KeyboardInterrupt, typer.Abort):
        status = _INTERRUPTED
    if status == _INTERRUPTED:  # Newer versions of typer return it, older ones raise Abort.
        _end("interrupted; what was written before stays", _INTERRUPTED)
    sys.exit(status or 0)


def _usage(error: Any) -> str:
    """A wrong option or argument in one line, and where to read about the right ones."""
    command = error.ctx.command_path if error.ctx is not None else "mala-drake"
    return f"{' '.join(error.format_message().split()).rstrip('.')}; see {command} --help"


def _end(line: str, status: int) -> NoReturn:
    sys.stderr.write(f"mala-drake: {line}\n")
    sys.exit(status)


if __name__ == "__main__":
    main()
