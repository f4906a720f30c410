"""Links that grow as the gearboxes warm up: how much and with which temperature trade against each other."""

import numpy as np

from bench.diagnose.diagnose import diagnose
from bench.diagnose.linearise.candidates import causes_of
from bench.diagnose.replay.segments import conditions_of
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.hide.campaign import hide_campaign
from bench.robot.folder import load_robot
from bench.scenario.files import read_as
from bench.scenario.session import SessionScenario
from tests.diagnose.sweeps import LOADS, made, nominal


def test_growth_is_named_though_neither_of_its_numbers_is_clear_by_itself() -> None:
    """At two thirds of its largest size it was never found: its fit was dropped as one that does not act."""
    effects, compiled = catalogue(), nominal()
    effect = effects["thermal_growth"]
    acting = Acting(effect, effect.places(compiled)[0], effect.complete({"expansion": 1.6e-5}))
    session = read_as(SessionScenario, "session-study")
    few = tuple(sweep for sweep in session.rotations if sweep.joint in (2, 3))  # the tracker sees most of them
    session = session.model_copy(update={"rotations": few})
    campaign = hide_campaign(load_robot("hh150"), session, [acting], np.random.default_rng(9900)).campaign
    choice = ("thermal_growth", "tracker_drift", "tracker_creep", "tracker_step", "link_length")
    best = diagnose(campaign, compiled, {name: effects[name] for name in choice}, proposes=False).naming.models[0].fit
    assert [cause.key for cause in best.causes] == [("thermal_growth", "robot")]
    expansion, soak = best.values
    print(f"expansion {expansion:.2e} +- {best.sigma[0]:.1e} /K, soak {soak:.2f} +- {best.sigma[1]:.2f}")
    (off,), ((variance,),) = best.sizes_against_none(best.causes[0])
    assert off > 3 * np.sqrt(variance)
    assert abs(expansion - 1.6e-5) < 2 * best.sigma[0]


def test_links_are_as_warm_as_the_air_where_no_gearbox_is_measured() -> None:
    """A day 8 K warmer was named a scale of the laser tracker, at 100 %: growth was looked for with gearboxes alone."""
    campaign = made(LOADS, seed=5, without=("gear_temperature",))
    run = campaign.runs[0]
    air = run.columns["ambient_temperature_k"]
    conditions = conditions_of(run, slice(0, len(air)), 6)
    np.testing.assert_allclose(conditions.gear_k, np.mean(air))
    channels = {"reflector", "current"}
    with_air, without = (
        {cause.effect.name for cause in causes_of(catalogue().values(), nominal(), frozenset(measured))}
        for measured in (channels | {"ambient_temperature"}, channels)
    )
    assert with_air - without == {"thermal_growth"}
