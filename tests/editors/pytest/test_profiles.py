"""The server under the profiles of three editors: what each says that it can, and the encoding that it then counts in.

pytest-lsp checks beside every assertion here that nothing is sent that a profile does not know (see pytest.ini). The
program is the one that GEOTRACE_BIN names. Where it runs on a system of its own, GEOTRACE_FOLDER is the URI of a folder
for documents there, and GEOTRACE_EDITOR the number of a process that stands for the editor's.
"""

import asyncio
import os

import pytest
import pytest_lsp
from lsprotocol import types
from pytest_lsp import ClientServerConfig, LanguageClient, client_capabilities

pytestmark = pytest.mark.asyncio

FOLDER = os.environ.get("GEOTRACE_FOLDER", "file:///scratch")
URI = f"{FOLDER}/a%20program.gtr"
# Each profile's name, and the encoding that it prefers of those that it knows.
PROFILES = {
    "visual-studio-code": "utf-16",
    "neovim@0.11": "utf-8",
    "emacs": "utf-32",
}
PATIENCE = 60.0
# The first two characters of the second line cannot stand there; what follows them counts from behind them.
TEXT = """\
define tau = 2pi;
𝛼é define b = tau + sinn 2;
# 𝛼é
function f(x, y) = x y + tau;
"""


@pytest_lsp.fixture(
    params=list(PROFILES),
    config=ClientServerConfig(server_command=[os.environ["GEOTRACE_BIN"], "lsp"]),
)
async def client(request, lsp_client: LanguageClient):
    profile = request.param
    lsp_client.profile = profile
    lsp_client.published = []
    plain = lsp_client.protocol.fm.features[types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS]

    def record(params: types.PublishDiagnosticsParams):
        lsp_client.published.append(params)
        return plain(params)

    lsp_client.protocol.fm.features[types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS] = record
    process = int(os.environ.get("GEOTRACE_EDITOR", os.getpid()))
    params = types.InitializeParams(capabilities=client_capabilities(profile), process_id=process)
    result = await lsp_client.initialize_session(params)
    lsp_client.encoding = result.capabilities.position_encoding or "utf-16"
    lsp_client.server = result.capabilities
    yield
    await lsp_client.shutdown_session()


def units(client, text: str) -> int:
    """The length of a text in the encoding that was agreed on."""
    match client.encoding:
        case "utf-8":
            return len(text.encode())
        case "utf-16":
            return len(text.encode("utf-16-le")) // 2
        case "utf-32":
            return len(text)
        case other:
            raise AssertionError(other)


def place(client, needle: str, text: str = TEXT, behind: bool = False) -> types.Position:
    """Where a piece of the text starts, or ends, as the client counts."""
    at = text.index(needle) + (len(needle) if behind else 0)
    before = text[:at]
    return types.Position(before.count("\n"), units(client, before[before.rfind("\n") + 1 :]))


def span(client, needle: str, text: str = TEXT) -> types.Range:
    return types.Range(place(client, needle, text), place(client, needle, text, behind=True))


def document(uri: str = URI) -> types.TextDocumentIdentifier:
    return types.TextDocumentIdentifier(uri)


def open_document(client, text: str = TEXT, uri: str = URI, language: str = "geotrace"):
    item = types.TextDocumentItem(uri, language, 1, text)
    client.text_document_did_open(types.DidOpenTextDocumentParams(item))


def change(client, version: int, *changes, uri: str = URI):
    params = types.DidChangeTextDocumentParams(
        types.VersionedTextDocumentIdentifier(version=version, uri=uri), list(changes)
    )
    client.text_document_did_change(params)


async def pushed(client, version: int, uri: str = URI):
    """The diagnostics that the server sends first for a version."""
    sent = await eventually(
        lambda: next((it for it in client.published if it.uri == uri and it.version == version), None)
    )
    return list(sent.diagnostics)


async def eventually(condition):
    """Waits until a condition gives a value."""

    async def found():
        while not (value := condition()):
            await asyncio.sleep(0.005)
        return value

    return await asyncio.wait_for(found(), PATIENCE)


def splice(client, text: str, edits) -> str:
    """A text after edits whose places the client counts; they may not overlap."""
    lines = text.split("\n")

    def offset(position):
        line = lines[position.line]
        start = sum(len(other) + 1 for other in lines[: position.line])
        lengths = [units(client, line[:k]) for k in range(len(line) + 1)]
        assert position.character in lengths, f"{position} lies within a character"
        return start + lengths.index(position.character)

    spans = [(offset(edit.range.start), offset(edit.range.end), edit.new_text) for edit in edits]
    for start, end, new in sorted(spans, reverse=True):
        text = text[:start] + new + text[end:]
    return text


def colored(client, data, text: str) -> list[tuple[str, str]]:
    """The words of a text and their types, from the numbers of its semantic tokens."""
    legend = client.server.semantic_tokens_provider.legend.token_types
    lines, line, column, tokens = text.split("\n"), 0, 0, []
    for k in range(0, len(data), 5):
        down, right, length, kind, _ = data[k : k + 5]
        line, column = line + down, right if down else column + right
        ends = [units(client, lines[line][:n]) for n in range(len(lines[line]) + 1)]
        start, end = ends.index(column), ends.index(column + length)
        tokens.append((lines[line][start:end], legend[kind]))
    return tokens


async def test_positions_are_in_the_encoding_that_the_client_prefers(client):
    assert client.encoding == PROFILES[client.profile]


async def test_pushed_diagnostics_stand_where_the_client_counts(client):
    open_document(client)
    found = await pushed(client, 1)
    assert [(d.code, d.range) for d in found] == [
        ("bad-character", span(client, "𝛼é")),
        ("undefined-name", types.Range(place(client, "n 2;"), place(client, " 2;"))),
    ]
    assert all(d.source == "geotrace" for d in found)
    # An edit behind what counts differently in each encoding.
    change(client, 2, types.TextDocumentContentChangePartial(span(client, "sinn"), "sin"))
    assert [d.code for d in await pushed(client, 2)] == ["bad-character"]
    change(client, 3, types.TextDocumentContentChangePartial(span(client, "𝛼é "), ""))
    assert await pushed(client, 3) == []


async def test_who_asks_for_diagnostics_is_not_told_twice(client):
    if client.capabilities.text_document.diagnostic is None:
        # This client never asks: that it is told unasked is the test above.
        open_document(client)
        assert len(await pushed(client, 1)) == 2
        return
    open_document(client)
    report = await client.text_document_diagnostic_async(types.DocumentDiagnosticParams(document()))
    assert [d.range for d in report.items][0] == span(client, "𝛼é")
    again = await client.text_document_diagnostic_async(
        types.DocumentDiagnosticParams(document(), previous_result_id=report.result_id)
    )
    assert again.kind == "unchanged"
    change(client, 2, types.TextDocumentContentChangePartial(span(client, "𝛼é "), ""))
    report = await client.text_document_diagnostic_async(
        types.DocumentDiagnosticParams(document(), previous_result_id=report.result_id)
    )
    assert [d.code for d in report.items] == ["undefined-name"]
    assert list(client.diagnostics[URI]) == []
    assert all(params.version != 2 for params in client.published)


async def test_hover_stands_on_the_word(client):
    open_document(client)
    at = place(client, "tau + sinn")
    hover = await client.text_document_hover_async(types.HoverParams(document(), at))
    assert hover.range == types.Range(at, place(client, " + sinn"))
    assert "= 6.2832" in hover.contents.value


async def test_tokens_count_as_the_client_does(client):
    open_document(client)
    full = await client.text_document_semantic_tokens_full_async(types.SemanticTokensParams(document()))
    tokens = colored(client, full.data, TEXT)
    assert ("# 𝛼é", "comment") in tokens
    assert tokens[3:8] == [
        ("pi", "variable"),
        ("define", "keyword"),
        ("b", "variable"),
        ("tau", "variable"),
        ("+", "operator"),
    ]
    change(client, 2, types.TextDocumentContentChangePartial(span(client, "tau + sinn"), "tau"))
    delta = await client.text_document_semantic_tokens_full_delta_async(
        types.SemanticTokensDeltaParams(document(), full.result_id)
    )
    data = list(full.data)
    for edit in sorted(delta.edits, key=lambda edit: edit.start, reverse=True):
        data[edit.start : edit.start + edit.delete_count] = edit.data or []
    now = await client.text_document_semantic_tokens_full_async(types.SemanticTokensParams(document()))
    assert data == list(now.data)
    assert colored(client, data, TEXT.replace("tau + sinn", "tau")) != tokens


async def test_renaming_changes_every_use_and_nothing_else(client):
    open_document(client)
    edit = await client.text_document_rename_async(
        types.RenameParams(document(), place(client, "tau + sinn"), "turn")
    )
    if edit.document_changes is not None:
        assert edit.document_changes[0].text_document.version == 1
        edits = edit.document_changes[0].edits
    else:
        edits = edit.changes[URI]
    assert splice(client, TEXT, edits) == TEXT.replace("tau", "turn")


async def test_completion_replaces_the_word_that_is_begun(client):
    text = TEXT.replace("tau + sinn 2;", "ta")
    open_document(client, text)
    at = place(client, "define b = ta", text, behind=True)
    answer = await client.text_document_completion_async(types.CompletionParams(document(), at))
    items = answer if isinstance(answer, list) else answer.items
    [tau] = [item for item in items if item.label == "tau"]
    assert tau.text_edit.range == types.Range(place(client, "ta\n", text), at)
    assert splice(client, text, [tau.text_edit]).startswith("define tau = 2pi;\n𝛼é define b = tau\n")
    completion = client.capabilities.text_document.completion.completion_item
    if not completion.snippet_support:
        assert all(item.insert_text_format != types.InsertTextFormat.Snippet for item in items)
    resolved = await client.completion_item_resolve_async(tau)
    # Who names no format takes strings alone.
    documentation = resolved.documentation
    if completion.documentation_format is not None:
        documentation = documentation.value
    assert "define tau" in documentation


async def test_formatting_moves_blanks_alone(client):
    text = TEXT.replace(" = tau", "=tau").replace("x y", "x   y")
    open_document(client, text)
    edits = await client.text_document_formatting_async(
        types.DocumentFormattingParams(document(), types.FormattingOptions(4, True))
    )
    laid_out = splice(client, text, edits)
    assert "".join(laid_out.split()) == "".join(text.split())
    # What cannot be read stays as it is.
    assert "define b=tau + sinn 2;" in laid_out and "x y + tau;" in laid_out


async def test_colours_stand_where_the_client_counts(client):
    text = "# 𝛼é\n" + "point p = (0,0,0), color : (1, 0.5, 0);\n"
    open_document(client, text)
    params = types.DocumentColorParams(document())
    [found] = await client.text_document_document_color_async(params)
    assert found.range == span(client, "(1, 0.5, 0)", text)
    assert (found.color.red, found.color.green, found.color.blue) == (1.0, 0.5, 0.0)
    params = types.ColorPresentationParams(document(), found.color, found.range)
    [same] = await client.text_document_color_presentation_async(params)
    assert splice(client, text, [same.text_edit]) == text


async def test_attributes_are_completed_where_the_client_counts(client):
    text = "light l = @ (0,0,1), po;  # 𝛼é\n"
    open_document(client, text)
    at = place(client, "po", text, behind=True)
    answer = await client.text_document_completion_async(types.CompletionParams(document(), at))
    items = answer if isinstance(answer, list) else answer.items
    [power] = [item for item in items if item.label == "power"]
    assert power.kind == types.CompletionItemKind.Property
    assert power.text_edit.range == span(client, "po", text)
