"""The tasks as graphs of states and actions, drawn from the PDDL itself (paper, Figs. "med_task" and "meal_task")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mala_drake.planning.care_tasks import TASK_NAMES, CareTask
from mala_drake.planning.task import PlanningTask
from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import FLOOR, INK, MUTED, PAPER, PLACE_COLORS, WIDTH, new_figure
from mala_drake.reporting.figures.task_sketch import LABEL_SIZE, TYPE_SIZE, Arrow, Node, Sketch, sketch
from mala_drake.reporting.figures.task_texts import TaskTexts
from mala_drake.reporting.task_graph import TaskGraph, task_graph
from mala_drake.reporting.wording import words
from mala_drake.ward.ward_map import Ward

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MARGIN = 0.1  # Inches.


def task_graph_pictures(ward: Ward) -> Iterator[Picture]:
    """A picture for each task that the robot knows."""
    for name in TASK_NAMES:
        task = CareTask(name, ward).planning_task
        graph = task_graph(task)
        texts = task_texts(task, graph)
        drawn = sketch(graph, texts, width=WIDTH - 2 * _MARGIN)
        yield Picture(f"task_{name}", f"The {words(name)} task", _caption(graph, drawn), draw(drawn, texts))


def task_texts(task: PlanningTask, graph: TaskGraph) -> TaskTexts:
    """The texts of a task's graph."""
    return TaskTexts(task.description, (fact for part in graph.parts for edge in part.edges for fact in edge.gained))


def _caption(graph: TaskGraph, drawn: Sketch) -> str:
    boxes = sum(len(part.nodes) for part in graph.parts)
    text = (
        "Drawn from the PDDL files. A box is a state of the task, named by the facts that have just become true; an "
        "arrow is an action, with where it can be done, in the color of that kind of place. Left out are numbers and "
        "where the robot is, and with them movements and recharging; states with the same future are one box "
        f"({boxes} instead of {graph.states})."
    )
    if any(arrow.aside for arrow in drawn.arrows):
        text += " Grey arrows lead to a state of the same stage, by an action named above."
    if len(graph.parts) > 1:
        text += " The parts can be worked on in any order, and meet in the last action."
    return text


def draw(drawn: Sketch, texts: TaskTexts) -> Figure:
    """The picture, as wide as the page, or wider if it has to be."""
    left, bottom, right, top = drawn.bounds
    width = max(WIDTH, right - left + 2 * _MARGIN)
    slack = (width - (right - left)) / 2
    figure = new_figure(width, top - bottom + 2 * _MARGIN)
    figure.set_layout_engine("none")  # Everything is in inches already.
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(left - slack, right + slack)
    axes.set_ylim(bottom - _MARGIN, top + _MARGIN)
    for arrow in drawn.arrows:
        _draw_arrow(axes, arrow, _color(texts.kind(arrow.places)))
    for node in drawn.nodes:
        _draw_node(axes, node)
    named = (arrow for arrow in drawn.arrows if arrow.text)
    for arrow, box in zip(named, drawn.labels, strict=True):
        _write(axes, arrow, box, _color(texts.kind(arrow.places)))
    return figure


def _color(kind: str | None) -> str:
    """The color of a kind of place; ink where there is none."""
    return PLACE_COLORS.get(kind or "", INK)


def _draw_node(axes: Axes, node: Node) -> None:
    from matplotlib.patches import FancyBboxPatch

    left, bottom, right, top = node.box
    rounding = 0.03
    axes.add_patch(
        FancyBboxPatch(
            (left + rounding, bottom + rounding),
            right - left - 2 * rounding,
            top - bottom - 2 * rounding,
            boxstyle=f"round,pad={rounding}",
            facecolor=FLOOR,
            edgecolor=INK if node.strong else MUTED,
            linewidth=1.0 if node.strong else 0.5,
            zorder=3,
        )
    )
    weight = "bold" if node.strong else "normal"
    axes.text(node.x, node.y, node.text, ha="center", va="center", fontsize=TYPE_SIZE, weight=weight, zorder=4)


def _draw_arrow(axes: Axes, arrow: Arrow, color: str) -> None:
    color, width = (MUTED, 0.5) if arrow.aside else (color, 0.8)
    axes.plot(*zip(*arrow.path, strict=True), color=color, linewidth=width, solid_capstyle="butt", zorder=2)
    style = {"arrowstyle": "-|>", "color": color, "linewidth": width, "mutation_scale": 6, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", arrow.path[-1], arrow.path[-2], arrowprops=style, zorder=2)
    if arrow.both_ways:
        axes.annotate("", arrow.path[0], arrow.path[1], arrowprops=style, zorder=2)


def _write(axes: Axes, arrow: Arrow, box: tuple[float, float, float, float], color: str) -> None:
    """The text of an arrow, on the side of it that its box is on."""
    from matplotlib.patheffects import withStroke

    left, bottom, right, top = box
    middle = arrow.at([0.5])[0, 0]
    leftward = (left + right) / 2 < middle
    axes.text(
        right if leftward else left,
        (bottom + top) / 2,
        arrow.text,
        ha="right" if leftward else "left",
        va="center",
        fontsize=LABEL_SIZE,
        color=color,
        linespacing=1.05,
        zorder=5,
        path_effects=[withStroke(linewidth=1.5, foreground=PAPER)],
    )
