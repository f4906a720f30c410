"""Campaigns to measure with: one that is simulated, and others of any size by repetition."""

from dataclasses import replace
from functools import cache

import numpy as np

from bench.effects.catalogue import catalogue
from bench.hide.campaign import hide_campaign
from bench.hide.request import effects_of
from bench.record.campaign import Campaign, Run
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.complementary import Complementary
from bench.scenario.files import read_scenario

PAUSE_S = 5.0  # [s] between runs


@cache
def hidden_gas_loss() -> Campaign:
    """Return the campaign of `bench hide gas_loss=0.12`."""
    session = read_scenario("session-short")
    assert not isinstance(session, Complementary)
    robot = load_robot(session.robot)
    acting = effects_of(("gas_loss=0.12",), compile_robot(robot), catalogue())
    return hide_campaign(robot, session, acting, np.random.default_rng(1)).campaign


def with_runs(campaign: Campaign, n: int) -> Campaign:
    """Return a campaign of n runs: all of it over and over, one after the other."""
    runs: list[Run] = []
    start = 0.0
    while len(runs) < n:
        source = campaign.runs[len(runs) % len(campaign.runs)]
        runs.append(replace(source, name=f"{source.name}-{len(runs)}", start_s=start))
        start += float(source.columns["time_s"][-1]) + PAUSE_S
    return replace(campaign, runs=tuple(runs))


def with_rows(campaign: Campaign, n: int) -> Campaign:
    """Return a campaign of one run with n rows: the longest way up and down, over and over."""
    ways = {run.name: run for run in campaign.of_kind("motion")}
    up = max((run for name, run in ways.items() if name.endswith("-up")), key=len)
    down = ways[up.name.removesuffix("up") + "down"]
    both = {name: np.concatenate([values, down.columns[name]]) for name, values in up.columns.items()}
    columns = {name: np.resize(values, n) for name, values in both.items()}
    columns["time_s"] = np.arange(n) * float(np.median(np.diff(up.columns["time_s"])))
    return replace(campaign, runs=(replace(up, columns=columns),))
