"""What is written as TOML reads back as it was, to the last digit."""

import tomllib

import pytest

from bench.basics.files.toml_output import toml_header, toml_line


@pytest.mark.parametrize(
    "value",
    [
        'a "quoted" \\ path, é\n\tand more',
        0.1 + 0.2,
        1e-300,
        7,
        [1.0, -2.5e-9],
        ["a", 'b"'],
        [[1.0, 2.0], [3.0, 4.0]],
        {"left": 1.0, "a b.c": [2.5e-7, 0.0]},
    ],
)
@pytest.mark.parametrize("key", ["mass", "a b", "x.y", 'say "so"'])
def test_a_line_reads_back(key, value):
    assert tomllib.loads(f"{toml_header('payloads', key)}\n{toml_line(key, value)}\n") == {
        "payloads": {key: {key: value}}
    }
