"""CRT scripts under the profiles of three editors (see test_profiles.py)."""

import pytest
from lsprotocol import types
from test_profiles import (  # noqa: F401
    FOLDER,
    change,
    client,
    colored,
    document,
    eventually,
    open_document,
    place,
    pushed,
    span,
    splice,
)

pytestmark = pytest.mark.asyncio

URI = f"{FOLDER}/a%20script.crt"
# A string before each place counts differently in each encoding.
TEXT = """\
note = "𝛼é" ball = Sphere { radius -> 0.5 center -> vec3(0, 1, 0) }
n = 6 * 3
"𝛼é" + n  row = Macro (step) { ball <translate vec3(step, 0, 0)> }
sky = Background { image -> "𝛼/noon.png" }
Settings { background -> sky lights -> [PointLight { origin -> vec3(0, 5, -5) color -> rgb(1, 0.5, 0) }] }
Scene { row(1.5) }
"""


def opened(client, text: str = TEXT):  # noqa: F811
    open_document(client, text, URI, "crt")


async def answer(client, request, kind, *rest):  # noqa: F811
    return await request(kind(document(URI), *rest))


async def test_diagnostics_stand_where_the_client_counts(client):  # noqa: F811
    text = TEXT.replace("Sphere {", "Sphere { radios -> 1")
    opened(client, text)
    read = ("unknown-attribute", span(client, "radios", text))
    run = ("no-effect", span(client, '"𝛼é" + n', text))
    if client.capabilities.text_document.diagnostic is None:
        # What reading finds is there first, and what the run finds comes after it.
        await pushed(client, 1, URI)
        found = await eventually(lambda: (all := client.published[-1].diagnostics) and len(all) > 1 and all)
    else:
        report = await answer(client, client.text_document_diagnostic_async, types.DocumentDiagnosticParams)
        found = report.items
    assert [(d.code, d.range) for d in found if d.code != "missing-image"] == [read, run]
    assert "did you mean `radius`" in found[0].message


async def test_a_variable_is_described_with_its_value(client):  # noqa: F811
    opened(client)
    at = place(client, "n = 6", TEXT)
    hover = await answer(client, client.text_document_hover_async, types.HoverParams, at)
    assert hover.range == types.Range(at, place(client, " = 6", TEXT))
    assert "`18`, an Integer" in hover.contents.value
    at = place(client, "radius", TEXT)
    hover = await answer(client, client.text_document_hover_async, types.HoverParams, at)
    assert "Required" in hover.contents.value


async def test_tokens_count_as_the_client_does(client):  # noqa: F811
    opened(client)
    full = await answer(client, client.text_document_semantic_tokens_full_async, types.SemanticTokensParams)
    tokens = colored(client, full.data, TEXT)
    for wanted in [
        ("Macro", "keyword"),
        ("radius", "property"),
        ("vec3", "function"),
        ("n", "variable"),
        ("step", "parameter"),
    ]:
        assert wanted in tokens, wanted


async def test_renaming_keeps_to_the_scope(client):  # noqa: F811
    opened(client)
    at = place(client, "step,", TEXT)
    edit = await answer(client, client.text_document_rename_async, types.RenameParams, at, "distance")
    edits = edit.document_changes[0].edits if edit.document_changes is not None else edit.changes[URI]
    assert splice(client, TEXT, edits) == TEXT.replace("step", "distance")


async def test_attributes_are_completed(client):  # noqa: F811
    text = '"𝛼é" a = Torus { radius -> 1 tu'
    opened(client, text)
    at = place(client, "tu", text, behind=True)
    found = await answer(client, client.text_document_completion_async, types.CompletionParams, at)
    items = found if isinstance(found, list) else found.items
    [tube] = [item for item in items if item.label == "tube"]
    assert tube.kind == types.CompletionItemKind.Property
    assert tube.text_edit.range.end == at


async def test_the_layout_has_one_attribute_a_line(client):  # noqa: F811
    opened(client)
    options = types.FormattingOptions(4, True)
    edits = await answer(client, client.text_document_formatting_async, types.DocumentFormattingParams, options)
    laid_out = splice(client, TEXT, edits)
    assert "".join(laid_out.split()) == "".join(TEXT.split())
    assert "{\n    radius -> 0.5\n    center -> vec3(0, 1, 0)\n}" in laid_out


async def test_colours_and_images_stand_where_the_client_counts(client):  # noqa: F811
    opened(client)
    [color] = await answer(client, client.text_document_document_color_async, types.DocumentColorParams)
    assert color.range == span(client, "rgb(1, 0.5, 0)", TEXT)
    assert (color.color.red, color.color.green, color.color.blue) == (1.0, 0.5, 0.0)
    [link] = await answer(client, client.text_document_document_link_async, types.DocumentLinkParams)
    assert link.range == span(client, "𝛼/noon.png", TEXT)


async def test_an_edit_is_read_again(client):  # noqa: F811
    opened(client)
    change(client, 2, types.TextDocumentContentChangePartial(span(client, "6 * 3", TEXT), "5"), uri=URI)
    at = place(client, "n = 6", TEXT)
    hover = await answer(client, client.text_document_hover_async, types.HoverParams, at)
    assert "`5`, an Integer" in hover.contents.value
