"""The sections of the benchmark, in the order in which they are measured. A new one is a file and an entry here."""

from collections.abc import Mapping

from bench.benchmark import actuators, environment, growth, identification, phases, replay
from bench.benchmark.section import Section

SECTIONS: Mapping[str, Section] = {
    "actuators": Section("mj_step with the custom actuators", actuators.measure),
    "environment": Section("steps of the Gymnasium environment", environment.measure),
    "identification": Section(
        "stiffness from 108 states at rest, against mujoco.sysid", identification.measure, ("tabulate", "sysid")
    ),
    "replay": Section("replay in C, against the same in NumPy", replay.measure),
    "growth": Section("time over rows, runs and candidates", growth.measure),
    "phases": Section("one diagnosis by phase", phases.measure),
}
