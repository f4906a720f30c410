"""The plots of a prediction's recording."""

import numpy as np

from bench.predict.prediction import PredictedRecording
from bench.report.diagnosis.recording_clock import recording_clock_of
from bench.report.prediction.recording import _plots

MOST = 9  # plots under one tab of 1000 px that still have an axis one can read


def test_what_is_left_is_one_plot_for_each_kind(plain: PredictedRecording) -> None:
    found, clock = plain, recording_clock_of(plain.linear)
    plots = _plots(found, clock)
    tabs = [plot.tab for plot in plots]
    assert max(tabs.count(tab) for tab in tabs) <= MOST
    left = [plot for plot in plots if plot.tab == "Left over"]
    told = [q for c, q in enumerate(found.linear.quantities) if np.any(np.isfinite(found.error[:, c]))]
    assert len(left) == len({(quantity.kind, quantity.unit) for quantity in told})
    assert sum(len(plot.curves) for plot in left) == len(told) == len(plots) - len(left)
    assert tabs.index("Left over") == len(plots) - len(left), "what was measured comes first"
    (torque,) = [plot for plot in left if plot.title == "Motor torque, left by the model [Nm]"]
    assert [curve.name for curve in torque.curves] == ["motor torque 1"], "joint 2 stands"
    columns = [quantity.column for quantity in found.linear.quantities]
    expected = clock.curve(found.error[:, columns.index("tau_motor_1_nm")])
    np.testing.assert_array_equal(torque.curves[0].values, expected)
