"""Pictures of the viewer where it cannot draw."""

import subprocess
import sys

import pytest

from docs.pictures import viewer as screenshot


def test_a_viewer_that_ends_is_one_line_that_names_the_packages(tmp_path, monkeypatch, capsys):
    started = subprocess.Popen

    def ends_at_once(_command, **options):
        return started([sys.executable, "-c", "raise SystemExit(102)"], **options)

    monkeypatch.setattr(screenshot.subprocess, "Popen", ends_at_once)
    monkeypatch.setattr(sys, "argv", ["screenshot", "some.rrd", str(tmp_path / "picture.png")])
    with pytest.raises(SystemExit) as ended:
        screenshot.main()
    assert ended.value.code == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "apt-get install mesa-vulkan-drivers libvulkan1" in err
    assert not list(tmp_path.iterdir())
