"""Campaigns on a Ray cluster: run with `pytest -m cluster` where `pip install -e ".[cluster]"` was run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import solar_env
from solar_env.support.campaigns import Campaign, Workers, each_done

pytestmark = [pytest.mark.cluster, pytest.mark.filterwarnings("default")]

# Enough for both nodes to get some of them: Ray hands them out at random.
CELLS = [{"clearance": 1e-5 * k} for k in range(10, 50)]


def angle(clearance: float) -> float:
    return float(solar_env.simulate({"clearance": clearance}, model="rigid-clearance", duration=0.5).angles[-1, 0])


def deploy(cell: Any) -> dict[str, Any]:
    """A short flight, and the node on which it was simulated."""
    import ray

    return {"node": ray.get_runtime_context().get_node_id(), "angle": angle(cell["clearance"])}


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    pytest.importorskip("ray")
    from ray.cluster_utils import Cluster

    with pytest.MonkeyPatch.context() as patch:
        # What runs on the nodes must be found there; the package is installed.
        patch.setenv("PYTHONPATH", str(Path(__file__).parents[1]))
        nodes = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
        nodes.add_node(num_cpus=1, wait=True)
        nodes.wait_for_nodes()
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
    assert [result["angle"] for result in results] == [angle(cell["clearance"]) for cell in CELLS]


def test_an_interrupted_campaign_goes_on(cluster: Any, tmp_path: Path) -> None:
    store = tmp_path / "cells.jsonl"
    run = Campaign(deploy, CELLS, store).run(Workers(None, "ray"))
    first = next(run)
    run.close()
    again = Campaign(deploy, CELLS, store)
    missing = list(again.missing)
    assert first not in missing
    assert sorted(cell["clearance"] for cell in again.run(Workers(None, "ray"))) == [x["clearance"] for x in missing]
    assert len(again.results()) == len(CELLS)


def test_a_task_that_fails_says_so_here(cluster: Any) -> None:
    with pytest.raises(ValueError, match="clearance"):
        list(each_done(deploy, [{"clearance": -1.0}], Workers(9, "ray")))


def _alive() -> list[dict[str, Any]]:
    import ray

    return [node for node in ray.nodes() if node["Alive"]]
