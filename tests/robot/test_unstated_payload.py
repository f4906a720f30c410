"""How heavy a payload may be that recordings of a started robot leave unstated: what its drives hold up."""

from pathlib import Path

import numpy as np
import pytest

from bench.record.units import STANDARD_GRAVITY
from tests.robot.test_assumed import started

LIFT = 2600.0  # [N]
WRIST = 80.0  # [Nm]
LEVER = 0.3  # [m], of the load point from the first hinge
GANTRY = f"""
<robot name="gantry">
  <link name="base"/>
  {{links}}
  <joint name="x" type="prismatic"><parent link="base"/><child link="l1"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="3" effort="1500" velocity="1"/></joint>
  <joint name="y" type="prismatic"><parent link="l1"/><child link="l2"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="1.5" effort="1100" velocity="1"/></joint>
  <joint name="z" type="prismatic"><parent link="l2"/><child link="l3"/><axis xyz="0 0 {{rise}}"/>
    <limit lower="0" upper="0.8" effort="{LIFT}" velocity="1"/></joint>
  <joint name="a" type="revolute"><parent link="l3"/><child link="l4"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="110" velocity="3"/></joint>
  <joint name="b" type="revolute"><parent link="l4"/><child link="l5"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="{WRIST}" velocity="3"/></joint>
  <joint name="tool" type="fixed"><parent link="l5"/><child link="tool0"/><origin xyz="0 0 -{LEVER}"/></joint>
  <link name="tool0"/>
</robot>
"""
LINK = """<link name="l{i}"><inertial><origin xyz="0 0 0"/><mass value="20"/>
  <inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


@pytest.mark.parametrize(("rise", "held"), [("1", LIFT), ("0", WRIST / LEVER)])
def test_a_gantry_carries_what_its_lift_holds(tmp_path: Path, rise: str, held: float) -> None:
    """3.4 kg were presumed of one for 40 kg: the torque of an upright hinge at a lever of the whole 3 m of travel.

    Without a lift, the hinge that is not upright holds it.
    """
    links = "".join(LINK.format(i=i) for i in range(1, 6))
    text = GANTRY.format(links=links, rise=rise).replace('xyz="0 0 0"/>\n    <limit', 'xyz="0 1 0"/>\n    <limit')
    figures = started(tmp_path, text, "gantry.urdf").compiled.robot.figures
    np.testing.assert_allclose(figures.uncertainty.payload_kg, held / STANDARD_GRAVITY, rtol=0.05)
    np.testing.assert_allclose(figures.rating.force_n, held / 5, rtol=0.05)
    (said,) = [line for line in figures.assumed if line.startswith("payload")]
    assert f"up to {figures.uncertainty.payload_kg:g} kg" in said
