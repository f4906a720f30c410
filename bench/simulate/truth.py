"""What a scorer may want to know of a simulated robot and its instruments, by name."""

from bench.record.truth import TrueValue
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import SystematicErrors


def true_parameters(compiled: CompiledRobot, errors: SystematicErrors) -> dict[str, TrueValue]:
    """Return the true parameters of a robot as it was simulated, and the gains of the instruments around it."""
    parameters = {"force_gain": TrueValue(errors.force_gain, "")}
    for i, drive in enumerate(compiled.robot.figures.drives):
        parameters[f"stiffness.{drive.joint}"] = TrueValue(float(compiled.stiffness[i]), "Nm/rad")
        parameters[f"current_gain.{drive.joint}"] = TrueValue(float(errors.current_gain[i]), "")
        parameters[f"motor_coulomb.{drive.joint}"] = TrueValue(float(compiled.motor_coulomb[i]), "Nm")
        parameters[f"link_coulomb.{drive.joint}"] = TrueValue(float(compiled.link_coulomb[i]), "Nm")
    if compiled.counterbalance:
        parameters["counterbalance.constant"] = TrueValue(compiled.counterbalance.gas_constant, "Nm")
        parameters["counterbalance.critical_length"] = TrueValue(compiled.counterbalance.critical_length, "m")
    return parameters
