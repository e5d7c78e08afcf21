"""Pictures of currents: what they hold, and that colours can be told apart."""

import numpy as np
import pytest
from matplotlib import pyplot as plt

from bench.dataset.robot import load_robot
from bench.document.colours import ON_DARK, ON_WHITE, rgb
from bench.document.figures.comparison import current_figure
from bench.document.figures.write import write_figure
from bench.document.numbers import error_std, percent
from bench.identification.result import relative_error
from tests.shown import dataset_of, identification_of

pytestmark = pytest.mark.pictures

# Simulation of full colour blindness in linear RGB (Machado, Oliveira and Fernandes 2009).
EYES = {
    "normal": np.eye(3),
    "protanope": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranope": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanope": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


@pytest.fixture(scope="module")
def result():
    return identification_of(dataset_of(load_robot("five_bar")))


def test_every_motor_and_recording_has_its_currents_and_its_error(result):
    axes = current_figure(result).axes
    assert len(axes) == 12  # current and error of two motors, three recordings
    grid = np.array(axes).reshape(3, 4).T
    for column, series in enumerate(result.recordings):
        assert series.name in grid[0, column].get_title(loc="left")
        assert percent(relative_error([series])) in grid[0, column].get_title(loc="left")
        for j in range(2):
            measured, modelled = (line.get_ydata() for line in grid[2 * j, column].get_lines())
            (error,) = (line.get_ydata() for line in grid[2 * j + 1, column].get_lines())
            np.testing.assert_array_equal(measured, series.measured[:, j])
            np.testing.assert_array_equal(modelled, series.modelled[:, j])
            np.testing.assert_allclose(error[3:], 1e3 * series.error[3:, j])
            assert np.isnan(error[:3]).all()  # stands still
    assert [axis.get_ylabel() for axis in grid[:, 0]] == ["left [A]", "error [mA]", "right [A]", "error [mA]"]


def test_the_band_is_that_of_the_fitted_recordings(result):
    fitted = np.concatenate([one.error[3:] for one in result.recordings if one.use == "identify"])
    np.testing.assert_allclose(error_std(result), np.sqrt((fitted**2).mean(axis=0)))


@pytest.mark.parametrize(("suffix", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml")])
def test_a_picture_is_written_and_no_window_is_prepared(result, tmp_path, suffix, start):
    path = tmp_path / "deep" / f"currents{suffix}"
    write_figure(path, current_figure(result))
    assert path.read_bytes().startswith(start)
    assert [one.name for one in path.parent.iterdir()] == [path.name]
    assert plt.get_fignums() == []


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize(("palette", "ground"), [(ON_WHITE, "#FFFFFF"), (ON_DARK, "#0D1014")])
def test_colours_can_be_told_apart(palette, ground, eye):
    seen = [lab(colour, EYES[eye]) for colour in (palette.measured, palette.modelled, ground)]
    for first in range(3):
        for second in range(first):
            assert np.linalg.norm(seen[first] - seen[second]) > 25.0
    assert np.linalg.norm(lab(palette.error, EYES[eye]) - seen[2]) > 25.0


def lab(colour, eye):
    """CIE L*a*b* of a colour as an eye sees it; 2 is a difference that one just notices."""
    value = np.array(rgb(colour)) / 255.0
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ np.clip(np.asarray(eye) @ linear, 0.0, 1.0) / (0.9505, 1.0, 1.089)
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16.0 / 116.0)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])
