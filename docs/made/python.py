"""The public names with their signatures, each from the module that defines it."""

import mkdocs_gen_files

import bench

PAGE = "reference/python.md"
MARK = "<!-- names -->"


def names() -> str:
    """A section for each name, functions before classes."""
    found = [getattr(bench, name) for name in bench.__all__]
    found.sort(key=lambda one: isinstance(one, type))
    return "\n".join(
        f"::: {one.__module__}.{one.__qualname__}\n    options: {{heading_level: 3, show_root_full_path: false}}\n"
        for one in found
    )


with mkdocs_gen_files.open(PAGE, "r") as page:
    text = page.read()
with mkdocs_gen_files.open(PAGE, "w") as written:
    written.write(text.replace(MARK, names()))
