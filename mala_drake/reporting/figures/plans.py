"""Which plans were executed (paper, Sec. "Plan Adaptation and Diversity"): variants by patient, and meals chosen."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from mala_drake.reporting.figures.picture import Picture
from mala_drake.reporting.figures.style import INK, MUTED, PAPER, WIDTH, ink_on, new_figure, profile_color
from mala_drake.reporting.profile_results import ProfileResults, profile_results
from mala_drake.reporting.results import Results
from mala_drake.reporting.wording import readable_variant, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MEAL = "meal"
_FULL = 0.65  # Opacity of a cell from which it counts as having its full color, on a light and on a dark ground.
_DISH_COLORS = ("#9ecae1", "#5b9cc9", "#2f6f9f", "#184e77")


def variant_picture(results: Results) -> Iterator[Picture]:
    """A table a task: variants by patients, each cell the share of the patient's episodes."""
    figures = profile_results(results, results.main)
    tables = [(task, counted) for task in results.tasks if (counted := _sorted_variants(figures, task))]
    if not tables:
        return
    heights = [len(variants) + 1.6 for _, variants in tables]
    figure = new_figure(WIDTH, 0.5 + 0.24 * sum(heights))
    grid = figure.subplots(len(tables), 1, squeeze=False, height_ratios=heights)[:, 0]
    for axes, (task, variants) in zip(grid, tables, strict=True):
        _draw_table(axes, task, variants, figures)
    caption = (
        "Plan variants counted from the executed plans that reached their goal, as a share of the patient's episodes "
        "of that task. A medication plan is told by pharmacy, supply room, order and bedside, a meal by dish and side."
    )
    yield Picture("plans", "What the robot did for whom", caption, figure)


def _sorted_variants(figures: Sequence[ProfileResults], task: str) -> list[str]:
    total: Counter[str] = sum((each.variants(task) for each in figures), Counter())
    return [variant for variant, _ in sorted(total.items(), key=lambda item: (-item[1], item[0]))]


def _draw_table(axes: Axes, task: str, variants: list[str], figures: Sequence[ProfileResults]) -> None:
    from matplotlib.patches import Rectangle

    for column, each in enumerate(figures):
        color = profile_color(each.profile)
        counted = each.variants(task)
        episodes = sum(record.task == task for run in each.runs for record in run.episodes)
        for row, variant in enumerate(variants):
            if not counted[variant]:
                continue
            share = counted[variant] / episodes
            opacity = 0.12 + 0.88 * share
            axes.add_patch(Rectangle((column - 0.47, row - 0.44), 0.94, 0.88, color=color, alpha=opacity, linewidth=0))
            text = f"{100 * share:.0f} %" if share >= 0.005 else "< 1 %"
            axes.text(
                column, row, text, ha="center", va="center", color=INK if opacity < _FULL else ink_on(color), fontsize=7
            )
        name = f"{words(each.profile)}\n{len(counted)} variant{'s' * (len(counted) != 1)}"
        axes.text(column, -0.75, name, ha="center", va="bottom", color=color, weight="bold", fontsize=7)
    axes.set_title(words(task).capitalize(), loc="left", pad=26)
    axes.set_yticks(range(len(variants)), [readable_variant(variant) for variant in variants])
    axes.set_xlim(-0.5, len(figures) - 0.5)
    axes.set_ylim(len(variants) - 0.5, -0.5)
    axes.set_xticks([])
    axes.tick_params(axis="y", length=0, labelcolor=INK)
    axes.grid(visible=False)
    for spine in axes.spines.values():
        spine.set_visible(False)


def dish_shares(figures: ProfileResults) -> dict[str, float]:
    """The share of each dish in the meals that were delivered, by the first part of the plan variant."""
    dishes: Counter[str] = Counter()
    for variant, count in figures.variants(_MEAL).items():
        dishes[variant.split("/")[0]] += count
    return {dish: count / dishes.total() for dish, count in sorted(dishes.items())}


def meal_picture(results: Results) -> Iterator[Picture]:
    """The meals chosen: a bar a patient, a part a dish. Nothing where no meal was made."""
    shares = {each.profile: dish_shares(each) for each in profile_results(results, results.main)}
    dishes = sorted({dish for of_profile in shares.values() for dish in of_profile})
    if not dishes:
        return
    figure = new_figure(WIDTH, 0.45 + 0.27 * len(shares))
    axes = figure.subplots()
    colors = {dish: _DISH_COLORS[i % len(_DISH_COLORS)] for i, dish in enumerate(dishes)}
    for row, of_profile in enumerate(shares.values()):
        left = 0.0
        for dish, share in of_profile.items():
            axes.barh(row, share, left=left, height=0.78, color=colors[dish], edgecolor=PAPER, linewidth=0.8)
            if share > 0.12:
                text = f"{words(dish)} {100 * share:.0f} %"
                axes.text(left + share / 2, row, text, ha="center", va="center", color=ink_on(colors[dish]), fontsize=7)
            left += share
    axes.set_yticks(range(len(shares)), [words(profile) for profile in shares])
    for label, profile in zip(axes.get_yticklabels(), shares, strict=True):
        label.set_color(profile_color(profile))
        label.set_fontweight("bold")
    axes.set_xlim(0, 1)
    axes.set_ylim(len(shares) - 0.5, -0.5)
    axes.set_xticks([0, 0.5, 1], ["0", "50 %", "100 %"], color=MUTED)
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False)
    axes.spines["left"].set_visible(False)
    yield Picture("meals", "Which meal for whom", "Share of each dish among the delivered meals, by patient.", figure)
