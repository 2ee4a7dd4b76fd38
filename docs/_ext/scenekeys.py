"""The keys of a scene's table as the book shows them: ``.. scene-keys:: contact``, or a table within a table,
``body.box``.

Type, unit, limits, default and meaning come from the package's own model, from which scenes are read; nothing is typed
here.
"""

from __future__ import annotations

from sphinx.util.docutils import SphinxDirective


def table_of(path: str):
    """The table of the model that stands at a path such as ``body.box``."""
    from libcontact.parts import MANY, ONCE

    first, *inner = path.split(".")
    table = {**MANY, **ONCE}[first]
    for name in inner:
        table = table.keys()[name].metadata["kind"].model
    return table


def value_of(schema: dict) -> str:
    """What a key may hold, from its JSON Schema."""
    from libcontact.schema import Surface

    if "enum" in schema:
        return " ".join(f'``"{word}"``' for word in schema["enum"])
    if "const" in schema:
        return f"``{str(schema['const']).lower()}``"
    if "anyOf" in schema:
        if any("items" not in each for each in schema["anyOf"]):
            return " or ".join(map(value_of, schema["anyOf"]))
        widths = [str(rows["items"]["minItems"]) for rows in schema["anyOf"]]
        return f"rows of {' or '.join(widths)} numbers"
    if "prefixItems" in schema:
        return f"{len(schema['prefixItems'])} of: {value_of(schema['prefixItems'][0])}"
    if schema["type"] == "array":
        return f"list of: {value_of(schema['items'])}"
    if "propertyNames" in schema:
        return f"table of names, each with a {value_of(schema['additionalProperties'])}"
    if schema["type"] == "object":
        return f"table: {', '.join(f'``{name}``' for name in schema['properties'])}"
    words = {"number": "number", "integer": "whole number", "string": "text", "boolean": "boolean"}
    signs = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}
    limits = [f"{sign} {schema[word]:g}" for word, sign in signs.items() if word in schema]
    if schema["type"] == "integer":
        limits = [f"≥ {schema['minimum']}"]
    if schema.get("pattern") == Surface.json["pattern"]:
        return "a face or a set"
    return ", ".join([words[schema["type"]], *limits])


def default_of(field) -> str:
    """The default of a key, or what stands in its place."""
    from libcontact.schema import required

    if required(field):
        return "required"
    if field.metadata["says"]:
        return field.metadata["says"]
    value = field.default
    if isinstance(value, tuple):
        if not value:
            return "none"
        if isinstance(value[0], str):
            return ", ".join(f'``"{each}"``' for each in value)
        return f"``{[int(each) for each in value]}``"
    return f'``"{value}"``' if isinstance(value, str) else f"{str(value).lower():.6}"


class SceneKeys(SphinxDirective):
    required_arguments = 1

    def run(self):
        try:
            import libcontact._core
            from libcontact.parts import MANY
        except ImportError as error:
            return self.parse_text_to_nodes(
                f"(This book was built without the Python package, so its table is missing here: {error}.)\n"
            )
        import libcontact.model

        for module in (libcontact._core, libcontact.model):
            self.env.note_dependency(module.__file__)
        path = self.arguments[0]
        table = table_of(path)
        name = f"[[{path}]]" if path in MANY else path if "." in path else f"[{path}]"
        text = [
            f".. list-table:: ``{name}``",
            "   :header-rows: 1",
            "   :widths: 15 20 15 50",
            "",
            "   * - key",
            "     - value",
            "     - default",
            "     - meaning",
        ]
        docs = table.docs()
        for key, field in table.keys().items():
            unit = f" [{field.metadata['unit']}]" if field.metadata["unit"] else ""
            text += [
                f"   * - ``{key}``",
                f"     - {value_of(field.metadata['kind'].schema())}{unit}",
                f"     - {default_of(field)}",
                f"     - {docs[key]}",
            ]
        return self.parse_text_to_nodes("\n".join(text) + "\n")


def setup(app):
    app.add_directive("scene-keys", SceneKeys)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
