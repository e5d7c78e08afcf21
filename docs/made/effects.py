"""The atlas: a page for each effect of the catalogue, from the catalogue itself."""

import inspect

import mkdocs_gen_files

from bench.effects import CATALOGUE, Effect

PLACES = {
    "actuator": "a motor",
    "passive": "a joint without a motor",
    "body": "a body",
    "payload": "a payload",
    "robot": "the robot as a whole",
}


def page(effect: Effect) -> str:
    """Law, parameters with units, where it sits, and the command that adds it."""
    about = inspect.cleandoc(type(effect).__doc__ or "")
    law = f"> {effect.law}\n>\n> {effect.symbols}\n" if effect.law else ""
    rows = [f"| `{one.name}` | {one.unit_at(True)} or {one.unit_at(False)} |" for one in effect.parameters]
    rows += [f"| `{one.name}` | {one.unit_at(True) or '1'}, found from the data |" for one in effect.shape]
    return "\n".join(
        (
            f"# {effect.name.replace('_', ' ').capitalize()}\n",
            law,
            f"{about}\n",
            f"To see it, {effect.shown_by}.\n",
            "| parameter | unit |\n|---|---|",
            *rows,
            f"\nSits at {PLACES[effect.place]}. Add it everywhere, or at one place:\n",
            "```sh",
            f"bench identify DATASET --with {effect.name}",
            f"bench identify DATASET --with {effect.name}:PLACE",
            "```",
        )
    )


for name, found in sorted(CATALOGUE.items()):
    with mkdocs_gen_files.open(f"atlas/{name}.md", "w") as written:
        written.write(page(found))
with mkdocs_gen_files.open("atlas/index.md", "w") as written:
    lines = [f"- [{name.replace('_', ' ')}]({name}.md)" for name in sorted(CATALOGUE)]
    written.write(
        "# Atlas of effects\n\nWhat a rigid-body model lacks, a page each.\n\n" + "\n".join(lines) + "\n"
    )
