"""The summary of an experiment against figures counted by hand."""

from __future__ import annotations

import json

import numpy as np
import pytest

from mala_drake.experiments import experiment_summary as mut
from mala_drake.experiments.episode_record import by_criterion
from mala_drake.experiments.experiment import Experiment, RunName
from mala_drake.scenario import Scenario

WISHES = (0.50, 0.12, 0.14, 0.14, 0.10)  # Of the speed-oriented.
DISTANCES = {0: (0.3, 0.1, 0.12), 1: (0.2, 0.16, 0.16), 2: (0.14, 0.05, 0.02)}
LEARNED = {0: (0.48, 0.12, 0.16, 0.14, 0.10), 1: (0.2,) * 5, 2: WISHES}


@pytest.fixture
def results(tmp_path, episode_record):
    """Three runs of three episodes under the main condition, and one of one under another."""
    experiment = Experiment(
        "convergence",
        Scenario(episodes=3),
        {"": {}, "noisy": {"patient": {"noise": 0.4}}},
        profiles=("speed_oriented",),
        seeds=(0, 1, 2),
    )

    def write(run, records):
        (tmp_path / run.folder).mkdir(parents=True)
        (tmp_path / run.folder / "episodes.jsonl").write_text("".join(each.to_json() + "\n" for each in records))

    for seed, distances in DISTANCES.items():
        failed = {"success": False, "failure": "blocked", "ratings": [None] * 5, "collisions": 2}
        write(
            RunName("", "speed_oriented", seed),
            [
                episode_record(
                    episode=episode,
                    seed=seed,
                    distance_to_true=distance,
                    weights_after=list(LEARNED[seed]),
                    plan_variant=f"plan {episode}",
                    **(failed if (seed, episode) == (1, 1) else {}),
                )
                for episode, distance in enumerate(distances)
            ],
        )
        write(RunName("noisy", "speed_oriented", seed), [episode_record(seed=seed)] if seed == 0 else [])
    return experiment, tmp_path


def test_figures_are_medians_over_the_runs_with_their_quartiles(results):
    summary = mut.summarise_experiment(*results, {})
    figures = summary["profiles"]["speed_oriented"]
    # After 2, never, and 1 rated episodes.
    assert figures["convergence_episode"] == 2
    assert figures["convergence_episode_quartiles"] == [1.5, None]
    assert figures["best_distance"] == 0.1
    assert figures["final_distance"] == 0.12
    assert figures["final_distance_quartiles"] == pytest.approx([0.07, 0.14])
    assert figures["success_rate"] == pytest.approx(8 / 9)
    assert figures["plan_variants"] == ["plan 0", "plan 1", "plan 2"]
    assert figures["plan_variant_counts"] == {"plan 0": 3, "plan 1": 2, "plan 2": 3}
    assert (figures["runs"], figures["converged"], figures["dominant_right"]) == (3, 2, 2)
    assert (figures["episodes"], figures["successes"], figures["collisions"]) == (9, 8, 2)


def test_totals_are_over_all_runs_of_the_condition(results):
    totals = mut.summarise_experiment(*results, {})["totals"]
    assert (totals["runs"], totals["converged"], totals["dominant_right"]) == (3, 2, 2)
    assert (totals["episodes"], totals["successes"], totals["collisions"]) == (9, 8, 2)
    assert totals["failures"] == ["blocked"]
    assert totals["prediction_error"] == pytest.approx(by_criterion([0.1] * 5))


def test_error_over_bound_is_the_root_mean_square_of_its_definition(results):
    # The bound of n ratings of features 0.5, with the simplex constraint, in closed form: variance of one weight is
    # s^2 (1 - 1/5) with s = sigma / (4 f sqrt(n)), all weights being equally well known.
    ratios = []
    for seed, rated in ((0, 3), (1, 2), (2, 3)):
        bound = 0.1 / (4 * 0.5 * np.sqrt(rated)) * np.sqrt(0.8)
        ratios += [(learned - wanted) / bound for learned, wanted in zip(LEARNED[seed], WISHES, strict=True)]
    totals = mut.summarise_experiment(*results, {})["totals"]
    assert totals["error_over_bound"] == pytest.approx(np.sqrt(np.mean(np.square(ratios))))


def test_without_noise_there_is_no_bound(results):
    experiment, folder = results
    experiment.base.patient.noise = 0.0
    assert mut.summarise_experiment(experiment, folder, {})["totals"]["error_over_bound"] is None


def test_other_conditions_stand_beside_the_main_one(results):
    summary = mut.summarise_experiment(*results, {})
    assert (summary["condition"], list(summary["conditions"])) == ("", ["noisy"])
    assert summary["conditions"]["noisy"]["totals"]["episodes"] == 1
    assert summary["conditions"]["noisy"]["profiles"]["speed_oriented"]["runs"] == 1
    assert summary["seed"] == [0, 1, 2]
    assert summary["timing"]["wall_s"] == 10.0
    assert summary["timing"]["cpu_s"] == 5.0


def test_what_is_unfinished_is_told(results):
    failures = {RunName("", "speed_oriented", 2): "episode 3: the roof fell in"}
    summary = mut.summarise_experiment(*results, failures)
    assert summary["unfinished"] == {"speed_oriented, seed 2": "episode 3: the roof fell in"}


def test_a_summary_is_json_even_of_nothing(tmp_path, results):
    experiment, _ = results
    for run in experiment.runs:
        (tmp_path / "none" / run.folder).mkdir(parents=True)
        (tmp_path / "none" / run.folder / "episodes.jsonl").touch()
    summary = mut.summarise_experiment(experiment, tmp_path / "none", {})
    assert json.loads(json.dumps(summary, allow_nan=False)) == summary
    assert (summary["totals"]["episodes"], summary["profiles"]) == (0, {})


def test_only_what_was_rated_since_a_change_of_mind_can_tell_what_is_wanted(tmp_path, episode_record):
    base = Scenario(episodes=3)
    base.patient.earlier_weights, base.patient.earlier_episodes = [0.2] * 5, 2
    experiment = Experiment("ablations", base, {"drift": {}}, profiles=("speed_oriented",), seeds=(0,))
    run = experiment.runs[0]
    (tmp_path / run.folder).mkdir(parents=True)
    distances = (0.1, 0.1, 0.2)
    records = [
        episode_record(episode=n, weights_after=list(LEARNED[0]), distance_to_true=distances[n]) for n in range(3)
    ]
    (tmp_path / run.folder / "episodes.jsonl").write_text("".join(each.to_json() + "\n" for each in records))
    bound = 0.1 / (4 * 0.5) * np.sqrt(0.8)
    expected = np.sqrt(np.mean(np.square((np.array(LEARNED[0]) - WISHES) / bound)))
    assert mut.summarise_experiment(experiment, tmp_path, {})["totals"]["error_over_bound"] == pytest.approx(expected)
    assert mut.summarise_experiment(experiment, tmp_path, {})["totals"]["converged"] == 0
    base.patient.earlier_episodes = 3
    assert mut.summarise_experiment(experiment, tmp_path, {})["totals"]["error_over_bound"] is None


def test_where_everything_matters_alike_nothing_can_be_dominant(tmp_path, episode_record):
    base = Scenario(episodes=1)
    base.patient.true_weights = [0.2] * 5
    experiment = Experiment("convergence", base, {"": {}}, profiles=("custom",), seeds=(0,))
    (tmp_path / experiment.runs[0].folder).mkdir(parents=True)
    (tmp_path / experiment.runs[0].folder / "episodes.jsonl").write_text(
        episode_record(profile="custom").to_json() + "\n"
    )
    summary = mut.summarise_experiment(experiment, tmp_path, {})
    assert summary["totals"]["dominant_right"] is summary["profiles"]["custom"]["dominant_right"] is None
