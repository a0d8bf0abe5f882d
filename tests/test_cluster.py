"""Campaigns on a Ray cluster: run with ``pytest -m cluster`` where ``pip install -e ".[cluster]"`` was run."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from solar_env.campaigns import Campaign, Workers, each_done

pytestmark = [pytest.mark.cluster, pytest.mark.filterwarnings("default")]

CELLS = [{"clearance": 1e-5 * k} for k in range(10, 22)]  # more than are handed out at a time


def deploy(cell: Any) -> dict[str, Any]:
    """A short flight, and the node of the cluster on which it was simulated."""
    import ray

    import solar_env

    trajectory = solar_env.simulate(dict(cell), model="rigid-clearance", duration=0.5)
    time.sleep(0.3)  # so that one node alone cannot take all
    return {"node": ray.get_runtime_context().get_node_id(), "angle": float(trajectory.angles[-1, 0])}


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    pytest.importorskip("ray")
    from ray.cluster_utils import Cluster

    with pytest.MonkeyPatch.context() as patch:
        # What runs on the nodes must be found there; the package is installed.
        patch.setenv("PYTHONPATH", str(Path(__file__).parent))
        nodes = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
        nodes.add_node(num_cpus=1)
        patch.setenv("RAY_ADDRESS", nodes.address)
        yield nodes
        import ray

        ray.shutdown()
        nodes.shutdown()


def test_a_campaign_runs_on_all_nodes_with_the_results_of_one_process(cluster: Any, tmp_path: Path) -> None:
    campaign = Campaign(deploy, CELLS, tmp_path / "cells.jsonl")
    assert len(list(campaign.run(Workers(None, "ray")))) == len(CELLS)
    results = campaign.results()
    assert {result["node"] for result in results} == {node["NodeID"] for node in _alive()}
    import solar_env

    alone = [solar_env.simulate(dict(cell), model="rigid-clearance", duration=0.5) for cell in CELLS]
    assert [result["angle"] for result in results] == [float(run.angles[-1, 0]) for run in alone]


def test_an_interrupted_campaign_goes_on(cluster: Any, tmp_path: Path) -> None:
    store = tmp_path / "cells.jsonl"
    run = Campaign(deploy, CELLS, store).run(Workers(None, "ray"))
    done = [next(run), next(run)]
    run.close()
    again = Campaign(deploy, CELLS, store)
    assert len(again.missing) <= len(CELLS) - len(done)
    finished = [cell for cell in CELLS if cell not in again.missing]
    assert [cell for cell in again.run(Workers(None, "ray")) if cell in finished] == []
    assert len(again.results()) == len(CELLS)


def test_a_task_that_fails_says_so_here(cluster: Any) -> None:
    with pytest.raises(ValueError, match="clearance"):
        list(each_done(deploy, [{"clearance": -1.0}], Workers(None, "ray")))


def _alive() -> list[dict[str, Any]]:
    import ray

    return [node for node in ray.nodes() if node["Alive"]]
