-- What a user of Neovim sees. Each test says what it expects; the exit status is 0 only if all passed.
local root, scratch = vim.env.GEOTRACE_ROOT, vim.env.GEOTRACE_SCRATCH

local suite = dofile(root .. "/tests/editors/neovim/suite.lua").new("Neovim", "", 8000, 10)

local function test(name, body)
  suite:test(name, body)
end

local function eventually(what, condition)
  return suite:eventually(what, condition)
end

local function equal(one, other, what)
  if not vim.deep_equal(one, other) then
    error(("%s: %s, wanted %s"):format(what or "is", vim.inspect(one), vim.inspect(other)))
  end
end

-- A new file with this text, of this language, in the current window, with the server attached.
local files = 0
local function open(text, extension)
  files = files + 1
  local path = ("%s/%d.%s"):format(scratch, files, extension or "gtr")
  vim.fn.writefile(vim.split(text, "\n"), path)
  vim.cmd.edit(path)
  eventually("the server", function()
    local client = vim.lsp.get_clients({ bufnr = 0, name = "geotrace" })[1]
    return client and client.initialized and client
  end)
  return vim.api.nvim_get_current_buf()
end

local function diagnostics()
  local found = vim.diagnostic.get(0)
  table.sort(found, function(a, b)
    return a.lnum < b.lnum or a.lnum == b.lnum and a.col < b.col
  end)
  return found
end

local function request(method, params)
  local client = vim.lsp.get_clients({ bufnr = 0, name = "geotrace" })[1]
  local answer = client:request_sync(method, params, 8000, 0)
  assert(answer, method .. ": no answer")
  assert(not answer.err, vim.inspect(answer.err))
  return answer.result
end

local function at(line, column)
  return { textDocument = vim.lsp.util.make_text_document_params(0), position = { line = line, character = column } }
end

-- The type of the token at a place, once there is one.
local function token_type(buffer, line, column)
  local tokens = vim.lsp.semantic_tokens.get_at_pos(buffer, line, column) or {}
  return tokens[1] and tokens[1].type
end

-- What is offered at a place.
local function labels(line, column)
  local items = request("textDocument/completion", at(line, column))
  return vim.tbl_map(function(item)
    return item.label
  end, items.items or items)
end

local function text()
  return table.concat(vim.api.nvim_buf_get_lines(0, 0, -1, false), "\n")
end

test("a .gtr file is a Geotrace program, and the server speaks UTF-8", function()
  open("define a = 1;")
  equal(vim.bo.filetype, "geotrace")
  equal(vim.bo.commentstring, "# %s")
  local client = vim.lsp.get_clients({ bufnr = 0 })[1]
  equal(client.offset_encoding, "utf-8")
end)

test("a mistake stands at its place, once, with its code", function()
  open("# 𝛼 beyond the first plane\ndefine b = 1 + sinn 2;")
  eventually("a diagnostic", function()
    return #diagnostics() > 0
  end)
  vim.wait(200)
  local found = diagnostics()
  equal(#found, 1)
  equal({ found[1].lnum, found[1].col, found[1].code }, { 1, 18, "undefined-name" })
  equal(found[1].source, "geotrace")
  assert(found[1].message:find("did you mean `sin`", 1, true), found[1].message)
end)

test("edits change the diagnostics, whatever they hold", function()
  open("define a = 1;\ndefine b = a;")
  vim.wait(100)
  equal(#diagnostics(), 0)
  vim.api.nvim_buf_set_lines(0, 0, 1, false, { "# é 𝛼", "define c = 1;" })
  eventually("the loss of a", function()
    local found = diagnostics()
    return #found == 1 and found[1].lnum == 2 and found[1].col == 11
  end)
  vim.api.nvim_buf_set_text(0, 1, 7, 1, 8, { "a" })
  eventually("all well again", function()
    return #diagnostics() == 0
  end)
end)

test("tokens are highlight groups by meaning", function()
  local buffer = open("param r : [1,2];\nsurface s(u,v) = (r cosu, sinu, v), u : [0,1], v : [0,1];")
  local function groups(line, column)
    local names = {}
    for _, token in ipairs(vim.lsp.semantic_tokens.get_at_pos(buffer, line, column) or {}) do
      table.insert(names, token.type)
      for modifier in pairs(token.modifiers) do
        table.insert(names, token.type .. "." .. modifier)
      end
    end
    table.sort(names)
    return names
  end
  eventually("tokens", function()
    return #groups(0, 0) > 0
  end)
  equal(groups(0, 0), { "keyword" })
  equal(groups(0, 6), { "variable", "variable.declaration", "variable.param" })
  equal(groups(1, 8), { "function", "function.declaration", "function.surface" })
  equal(groups(1, 20), { "function", "function.defaultLibrary" })
  equal(groups(1, 23), { "parameter" })
  local shown = vim.inspect_pos(buffer, 1, 23).semantic_tokens
  assert(#shown > 0 and shown[1].opts.hl_group:find("@lsp.type.parameter", 1, true), vim.inspect(shown))
end)

test("hover tells the value", function()
  open("define tau = 2pi;\ndefine b = tau/2;")
  local hover = request("textDocument/hover", at(1, 12))
  assert(hover.contents.value:find("= 6.2832", 1, true), hover.contents.value)
  equal(hover.range.start, { line = 1, character = 11 })
end)

test("renaming writes words apart where they would be read otherwise", function()
  open("define c = 2;\nfunction f(s) = cs;")
  vim.api.nvim_win_set_cursor(0, { 1, 7 })
  vim.lsp.buf.rename("ab")
  eventually("the new name", function()
    return text() == "define ab = 2;\nfunction f(s) = ab s;"
  end)
end)

test("formatting lays the text out", function()
  open("define   a=1 ;define b = a+1;")
  vim.lsp.buf.format({ timeout_ms = 8000 })
  equal(text(), "define a = 1;\ndefine b = a + 1;")
end)

test("definition, references and symbols are found", function()
  open("define a = 1;\nfunction f(x) = xa;")
  local definition = request("textDocument/definition", at(1, 17))
  equal(definition.range.start, { line = 0, character = 7 })
  local params = at(0, 7)
  params.context = { includeDeclaration = false }
  equal(#request("textDocument/references", params), 1)
  local symbols = request("textDocument/documentSymbol", { textDocument = at(0, 0).textDocument })
  equal({ symbols[1].name, symbols[2].name }, { "a", "f" })
end)

test("completion offers names and snippets", function()
  open("define radius = 1;\ndefine b = ra")
  local items = request("textDocument/completion", at(1, 13))
  local found = vim.iter(items.items or items):find(function(item)
    return item.label == "radius"
  end)
  assert(found, "radius is not offered")
  equal(found.textEdit.range.start, { line = 1, character = 11 })
end)

test("completion by omnifunc offers what matches, and replaces what is written", function()
  open("function tor(t, x) = t;\ndefine a = tor(1, co")
  vim.wait(100)
  vim.bo.omnifunc = "v:lua.vim.lsp.omnifunc"
  vim.cmd("set completeopt=menu,menuone,noinsert")
  local words
  vim.api.nvim_create_autocmd("CompleteChanged", {
    once = true,
    callback = function()
      words = vim.tbl_map(function(item)
        return item.word
      end, vim.fn.complete_info({ "items" }).items)
    end,
  })
  vim.api.nvim_win_set_cursor(0, { 2, 19 })
  vim.api.nvim_feedkeys(vim.keycode("A<C-x><C-o>"), "n", false)
  -- Keys are read while Neovim waits in insert mode.
  vim.defer_fn(function()
    vim.api.nvim_feedkeys(vim.keycode("<C-y><Esc>"), "n", false)
  end, 1500)
  vim.api.nvim_feedkeys("", "x!", false)
  assert(words and #words > 0, "nothing is offered")
  for _, word in ipairs(words) do
    assert(vim.startswith(word, "co"), vim.inspect(words))
  end
  equal(vim.api.nvim_buf_get_lines(0, 1, 2, false)[1], "define a = tor(1, cos")
end)

test("solids are coloured by meaning, completed and described", function()
  local buffer = open("solid ball(x,y,z) = x^2 + y^2 + z^2 - 1, color : (1, 0.5, 0);\n"
    .. "solid die = ball @ scale 2, io;\ncamera eye = (0,1,0) @ (0,-4,0), bokeh : star;")
  local function shown(line, column)
    return token_type(buffer, line, column)
  end
  eventually("tokens", function()
    return shown(0, 0)
  end)
  equal({ shown(0, 0), shown(0, 6), shown(0, 42), shown(1, 19), shown(2, 33), shown(2, 41) },
    { "keyword", "function", "property", "function", "property", "enumMember" })
  equal(labels(1, 30)[1], "ior")
  assert(vim.tbl_contains(labels(1, 12), "ball"), vim.inspect(labels(1, 12)))
  local hover = request("textDocument/hover", at(2, 34))
  assert(hover.contents.value:find("hexagon", 1, true), hover.contents.value)
  local colors = request("textDocument/documentColor", { textDocument = at(0, 0).textDocument })
  equal({ #colors, colors[1].color.green, colors[1].range.start.character }, { 1, 0.5, 49 })
end)

local script = [[
ball = Sphere { center -> vec3(0, 0.5, 0)  radius -> 0.5  material -> Material { color -> rgb(1, 0.5, 0) } }
n = 6 * 3
row = Macro (step) {
    i = 0
    while (i < n) { ball <translate vec3(step * i, 0, 0)> i = i + 1 }
}
Scene { row(1.5) }]]

test("a .crt file is a script, and a certificate is none", function()
  local buffer = open(script, "crt")
  equal({ vim.bo.filetype, vim.bo.commentstring }, { "crt", "-- %s" })
  local function shown(line, column)
    return token_type(buffer, line, column)
  end
  eventually("tokens", function()
    return shown(0, 0)
  end)
  equal({ shown(0, 0), shown(0, 16), shown(0, 26), shown(2, 6), shown(2, 13), shown(4, 4) },
    { "variable", "property", "function", "keyword", "parameter", "keyword" })
  equal(#diagnostics(), 0)
  equal(vim.filetype.match({ filename = "x.crt" }), "crt")
  local certificate = scratch .. "/certificate.crt"
  vim.fn.writefile({ "-----BEGIN CERTIFICATE-----", "MIIB==" }, certificate)
  vim.cmd.edit(certificate)
  equal(vim.bo.filetype == "crt", false)
  equal(#vim.lsp.get_clients({ bufnr = 0, name = "geotrace" }), 0)
end)

test("the mistakes of a script come with their places, and go with an edit", function()
  open(script:gsub("radius", "radios"), "crt")
  eventually("diagnostics", function()
    return #diagnostics() > 0
  end)
  local codes = vim.tbl_map(function(found)
    return found.code
  end, diagnostics())
  assert(vim.tbl_contains(codes, "missing-attribute") and vim.tbl_contains(codes, "unknown-attribute"), vim.inspect(codes))
  vim.api.nvim_buf_set_text(0, 0, 43, 0, 49, { "radius" })
  eventually("all well again", function()
    return #diagnostics() == 0
  end)
end)

test("a script is described, renamed, laid out and completed", function()
  open(script, "crt")
  local hover = request("textDocument/hover", at(1, 0))
  assert(hover.contents.value:find("`18`, an Integer", 1, true), hover.contents.value)
  hover = request("textDocument/hover", at(0, 44))
  assert(hover.contents.value:find("Required", 1, true), hover.contents.value)
  local symbols = vim.tbl_map(function(symbol)
    return symbol.name
  end, request("textDocument/documentSymbol", { textDocument = at(0, 0).textDocument }))
  equal(symbols, { "ball", "row", "Scene" })
  local colors = request("textDocument/documentColor", { textDocument = at(0, 0).textDocument })
  equal({ #colors, colors[1].color.green }, { 1, 0.5 })
  vim.api.nvim_win_set_cursor(0, { 4, 4 })
  vim.lsp.buf.rename("k")
  eventually("the new name", function()
    return text():find("vec3(step * k, 0, 0)> k = k + 1", 1, true)
  end)
  vim.lsp.buf.format({ timeout_ms = 8000 })
  assert(text():find("ball = Sphere {\n    center -> vec3(0, 0.5, 0)\n    radius -> 0.5\n", 1, true), text())
  vim.api.nvim_buf_set_lines(0, 0, 1, false, { "ball = Torus { tube -> 1" })
  vim.wait(100)
  equal(labels(1, 0), { "normal" })
end)

test("a script is converted into a program beside it", function()
  local buffer = open(script, "crt")
  local path = vim.api.nvim_buf_get_name(buffer):gsub("%.crt$", ".gtr")
  vim.lsp.buf.code_action({ apply = true, context = { only = { "source.convert" }, diagnostics = {} } })
  local converted = eventually("the program", function()
    -- The server has it shown when it is written.
    local found = vim.fn.bufnr(path)
    return found == vim.api.nvim_get_current_buf() and vim.api.nvim_buf_line_count(found) > 3 and found
  end)
  local lines = table.concat(vim.api.nvim_buf_get_lines(converted, 0, -1, false), "\n")
  assert(vim.startswith(lines, "# geotrace render ") and lines:find("solid ", 1, true), lines)
  vim.cmd.bwipeout({ converted, bang = true })
end)

test("a missing semicolon at the end of the file is fixed from its line", function()
  open("define a = 1;\ndefine b = 2\n\n")
  local found = eventually("a diagnostic", function()
    return diagnostics()[1]
  end)
  equal({ found.lnum, found.col }, { 1, 11 })
  vim.api.nvim_win_set_cursor(0, { 2, 0 })
  vim.lsp.buf.code_action({ apply = true, filter = function(action)
    return action.title == "Insert `;`"
  end })
  eventually("the change", function()
    return text():find("define b = 2;", 1, true)
  end)
end)

test("all certain fixes are one action", function()
  open("function f(t) = (cos(t)^2, ln(t));\ndefine a = f(1)_1;")
  eventually("diagnostics", function()
    return #diagnostics() == 4
  end)
  vim.lsp.buf.code_action({ apply = true, context = { only = { "source.fixAll" }, diagnostics = {} } })
  eventually("the change", function()
    return text() == "function f(t) = ((cos(t))^2, log(t));\ndefine a = (f(1))_1;"
  end)
end)

test("code actions mend a mistake", function()
  open("define b = sinn 2;")
  eventually("a diagnostic", function()
    return #diagnostics() > 0
  end)
  vim.api.nvim_win_set_cursor(0, { 1, 14 })
  vim.lsp.buf.code_action({ apply = true, filter = function(action)
    return action.title == "Change to `sin`"
  end })
  eventually("the change", function()
    return text() == "define b = sin 2;"
  end)
end)

test("inlay hints show how words are split", function()
  local buffer = open("function f(v) = piv;")
  vim.lsp.inlay_hint.enable(true, { bufnr = buffer })
  local hint = eventually("a hint", function()
    return vim.lsp.inlay_hint.get({ bufnr = buffer })[1]
  end)
  equal(hint.inlay_hint.label, "·")
  equal(hint.inlay_hint.position, { line = 0, character = 18 })
end)

test("the preview's command answers", function()
  open("define a = 1;")
  local messages = {}
  local before = vim.notify
  local handler = vim.lsp.handlers["window/showMessage"]
  vim.lsp.handlers["window/showMessage"] = function(_, params)
    table.insert(messages, params.message)
  end
  vim.cmd.GeotracePreview()
  eventually("a message", function()
    return messages[1]
  end)
  assert(messages[1]:find("preview", 1, true), messages[1])
  vim.lsp.handlers["window/showMessage"] = handler
  vim.notify = before
end)

test("the preview's command is completed by views and names", function()
  open("surface torus(u,v) = (u,v,0), u : [0,1], v : [0,1];\npoint p = (0,0,0);\nsurface t(u,v) = torus(u,v), u : [0,1], v : [0,1];\ncamera eye = (0,1,0) @ p;\nsolid ball(x,y,z) = x^2 + y^2 + z^2 - 1;")
  local function offered(line)
    return vim.fn.getcompletion("GeotracePreview " .. line, "cmdline")
  end
  equal(offered(""), { "3d", "geodesic", "traced" })
  equal(offered("traced "), { "eye" })
  equal(offered("ge"), { "geodesic" })
  equal(offered("geodesic "), { "torus", "t", "ball" })
  equal(offered("geodesic to"), { "torus" })
  equal(offered("geodesic t "), {})
  equal(offered("3d "), {})
end)

test("the health check finds the server", function()
  vim.cmd("checkhealth geotrace")
  local report = text()
  assert(report:find("OK", 1, true) and not report:find("ERROR", 1, true), report)
end)

-- A text as the tree-sitter grammar reads it, and what the query for colours captures, by the words of the text.
local source = root .. "/editors/tree-sitter"
local function treesitter(program)
  local root_node = vim.treesitter.get_string_parser(program, "geotrace"):parse()[1]:root()
  local highlights = table.concat(vim.fn.readfile(source .. "/queries/highlights.scm"), "\n")
  highlights = vim.treesitter.query.parse("geotrace", highlights)
  local found = {}
  for id, node in highlights:iter_captures(root_node, program) do
    found[vim.treesitter.get_node_text(node, program)] = highlights.captures[id]
  end
  return root_node, found
end

-- Programs with solids, with the words that they bring as names, and with errors.
local stage = [[
solid cube(x,y,z) = max(abs x, abs y, abs z) - 1/2, mirror : 0.1, color : [1,0,0]/2, x : [0,1,20];
solid die = cube \ ball & [rod | ring @ scale 2 @ (1,0,0) @ lean @ rotate (0,0,k + a)], glass : 0.95;
light lamp = @ (2,-2,4), falloff : 5;
light beam = (0,1,-1) @ (0,-3,3), angle : pi/8;
camera eye = (0,4,-1) @ (0,-4,1), aperture : 0.05, bokeh : star;
background sky(x,y,z) = (1 - z)(0.8,0.9,1) + z(0.1,0.3,0.6);
surface bowl(u,v) = (u,v,0), u : [0,1], v : [0,2pi], mirror : 0.8;
point p = (0,0,0), radius : 0.1;
]]
local names = [[
param light : [0,1];
define scale = light^2; define rotate = 2scale; function solid(camera) = camera + rotate;
curve color(radius) = (solid radius,
  light, scale), radius : [0,1];
]]

test("the tree-sitter grammar parses every example, and its queries hold", function()
  local folder = scratch .. "/tree-sitter"
  vim.fn.mkdir(folder .. "/parser", "p")
  local built = vim.system({ "cc", "-shared", "-fPIC", "-O1", "-I", source .. "/src", source .. "/src/parser.c",
    "-o", folder .. "/parser/geotrace.so" }):wait()
  equal(built.code, 0, built.stderr)
  vim.treesitter.language.add("geotrace", { path = folder .. "/parser/geotrace.so" })
  local examples = vim.fn.glob(root .. "/examples/*.gtr", true, true)
  assert(#examples > 20)
  vim.treesitter.query.parse("geotrace", table.concat(vim.fn.readfile(source .. "/queries/folds.scm"), "\n"))
  for _, path in ipairs(examples) do
    local program = table.concat(vim.fn.readfile(path), "\n") .. "\n"
    local root_node = treesitter(program)
    assert(not root_node:has_error(), path .. ": " .. root_node:sexpr())
  end
  -- The structure, by one declaration with every level of the operators.
  local program = "define x = -a b*c + sin^2 t'/y_1 (2, .5e3);"
  local root_node, found = treesitter(program)
  local left = "(juxtaposition (unary (word)) (product (word) (word)))"
  local called = "(call function: (component (word) (number)) (tuple (number) (number)))"
  local right = "(juxtaposition (power (word) (number)) (product (derivative (word)) " .. called .. "))"
  local wanted = "(program (define name: (word) value: (sum " .. left .. " " .. right .. ")))"
  equal(root_node:sexpr(), wanted, "the tree")
  equal({ found.define, found.x, found.sin, found["2"] }, { "keyword", "constant", "function.builtin", "number" })
  assert(treesitter("define x = ;"):has_error())
  -- Each way to end a line ends a comment.
  for _, ending in ipairs({ "\n", "\r\n", "\r" }) do
    local tree = treesitter("# c" .. ending .. "define b = a;")
    equal(tree:sexpr(), "(program (comment) (define name: (word) value: (word)))", vim.inspect(ending))
  end
end)

test("the tree-sitter grammar reads solids, and their words are names elsewhere", function()
  local root_node, found = treesitter(stage)
  assert(not root_node:has_error(), root_node:sexpr())
  for word, capture in pairs({ solid = "keyword", light = "keyword", camera = "keyword", background = "keyword",
    cube = "type", lamp = "variable", mirror = "property", bokeh = "property", scale = "function.builtin",
    u = "variable.parameter", ["\\"] = "operator", ["|"] = "operator", ["&"] = "operator" }) do
    equal(found[word], capture, word)
  end
  local set = treesitter("solid s = a \\ b @ scale 2 @ p & (c | d);")
  local placed = "(placed (placed (word) (map (number))) place: (word))"
  local wanted = "(difference (word) (intersection " .. placed .. " (group (union (word) (word)))))"
  equal(set:sexpr(), "(program (solid name: (word) value: " .. wanted .. "))")
  -- Functions without parentheses.
  local map = treesitter("solid s = a @ scale sqrt sin^2 -k @ rotate r;")
  wanted = "(juxtaposition (word) (juxtaposition (power (word) (number)) (unary (word))))"
  placed = "(placed (placed (word) (map " .. wanted .. ")) (map (word)))"
  equal(map:sexpr(), "(program (solid name: (word) value: " .. placed .. "))")
  root_node, found = treesitter(names)
  assert(not root_node:has_error(), root_node:sexpr())
  for word, capture in pairs({ light = "constant", scale = "constant", rotate = "constant", solid = "function",
    camera = "variable.parameter", color = "function", radius = "variable.parameter" }) do
    equal(found[word], capture, word)
  end
  for _, program in ipairs({ "solid s = ;", "solid s = a |;", "light l;", "camera c = (1,0,0);", "solid s = 1;",
    "background b(x,y,z) = 1, color;", "define d = a & b;" }) do
    assert(treesitter(program):has_error(), program)
  end
end)

test("before the server answers, words are coloured where they stand", function()
  local lines = vim.split(stage .. names, "\n")
  vim.cmd.enew()
  vim.api.nvim_buf_set_lines(0, 0, -1, false, lines)
  vim.cmd("syntax on | set syntax=geotrace")
  -- The group of a word, at its nth place in a line.
  local function group(line, word, nth)
    local from, column = 1, nil
    for _ = 1, nth or 1 do
      column = lines[line]:find("%f[%a]" .. word .. "%f[%A]", from)
      from = column + 1
    end
    return vim.fn.synIDattr(vim.fn.synID(line, column, 1), "name")
  end
  for line, word in ipairs({ "solid", "solid", "light", "light", "camera", "background" }) do
    equal(group(line, word), "geotraceKeyword", word)
  end
  for line, word in pairs({ "mirror", "glass", "falloff", "angle", "bokeh", [7] = "mirror", [8] = "radius" }) do
    equal(group(line, word), "geotraceAttribute", word)
  end
  equal({ group(2, "scale"), group(2, "rotate") }, { "geotraceFunction", "geotraceFunction" })
  for _, place in ipairs({ { 9, "light" }, { 10, "scale" }, { 10, "light" }, { 10, "rotate" }, { 10, "scale", 2 },
    { 10, "solid" }, { 11, "color" }, { 11, "radius" }, { 12, "light" }, { 12, "radius" } }) do
    equal(group(unpack(place)), "", place[2])
  end
  vim.cmd.bwipeout({ bang = true })
end)

test(":help geotrace opens the manual, and its links lead somewhere", function()
  local folder = scratch .. "/manual"
  vim.fn.mkdir(folder .. "/doc", "p")
  vim.fn.writefile(vim.fn.readfile(root .. "/editors/neovim/doc/geotrace.txt"), folder .. "/doc/geotrace.txt")
  vim.cmd.helptags(folder .. "/doc")
  vim.opt.runtimepath:append(folder)
  for _, tag in ipairs({ "geotrace", ":GeotracePreview", ":GeotraceRestart", "geotrace-setup" }) do
    vim.cmd.help(tag)
    equal(vim.fn.expand("%:t"), "geotrace.txt", tag)
    vim.cmd.close()
  end
  for tag in table.concat(vim.fn.readfile(folder .. "/doc/geotrace.txt"), "\n"):gmatch("|([^|%s]+)|") do
    assert(#vim.fn.getcompletion(tag, "help") > 0, "no help for " .. tag)
  end
end)

-- The one diagnostic of the current buffer comes, and it is of the server that runs now.
local function expect_new_diagnostic()
  local client = eventually("another server", function()
    local found = vim.lsp.get_clients({ bufnr = 0, name = "geotrace" })
    return #found == 1 and found[1].initialized and found[1]
  end)
  local of_client = "lsp%.geotrace%." .. client.id .. "%f[%D]"
  eventually("a diagnostic of the new server", function()
    return vim.iter(diagnostics()):any(function(it)
      return vim.diagnostic.get_namespace(it.namespace).name:find(of_client)
    end)
  end)
  vim.wait(300)
  equal(#diagnostics(), 1, "the number of diagnostics")
  return client
end

-- Opens a program with a mistake in a repository of its own, whose server answers after `delay` milliseconds.
local function open_repository(name, delay)
  local repository = ("%s/%s"):format(scratch, name)
  vim.fn.mkdir(repository .. "/.git", "p")
  vim.fn.writefile({ "define b = sinn 2;" }, repository .. "/a.gtr")
  vim.lsp.config("geotrace", {
    cmd = function(dispatchers)
      local server = vim.lsp.rpc.start({ "geotrace", "lsp" }, dispatchers)
      local ask = server.request
      server.request = function(method, params, answered, ...)
        return ask(method, params, function(...)
          local given = { ... }
          vim.defer_fn(function()
            answered(unpack(given, 1, 2))
          end, delay)
        end, ...)
      end
      return server
    end,
  })
  vim.cmd.edit(repository .. "/a.gtr")
  return eventually("the server", function()
    return vim.lsp.get_clients({ bufnr = 0, name = "geotrace" })[1]
  end)
end

test("restarting gives a new server and its diagnostics, and takes back those that the old one still tells", function()
  -- A server without a folder, whose buffers the others do not have.
  open("define a = 1;")
  local noted, notify = {}, vim.notify
  vim.notify = function(message)
    table.insert(noted, message)
  end
  for delay = 0, 200, 100 do
    -- The client is there as soon as it has asked for diagnostics, before they are answered.
    local before = open_repository("repository" .. delay, delay)
    vim.cmd.GeotraceRestart()
    local after = expect_new_diagnostic()
    assert(after.id ~= before.id, "the same server")
    assert(before.root_dir, "no folder with the marker")
    equal(after.root_dir, before.root_dir, "the folder")
  end
  vim.notify = notify
  equal(noted, {}, "what was said")
end)

test("restarting starts a server where it has crashed, or has not begun to answer", function()
  local crashed = open_repository("crashed", 0)
  crashed.rpc.terminate()
  eventually("its end", function()
    return vim.lsp.get_client_by_id(crashed.id) == nil
  end)
  vim.cmd.GeotraceRestart()
  expect_new_diagnostic()
  vim.fn.writefile({ "define b = cosn 2;" }, scratch .. "/crashed/.git/b.gtr")
  vim.cmd.edit(scratch .. "/crashed/.git/b.gtr")
  vim.cmd.GeotraceRestart()
  expect_new_diagnostic()
end)

test("the server is told the cursor of the window that it moves in", function()
  local buffer = open("define a = 1;\ndefine b = 2;\ndefine c = 3;")
  local client, told = vim.lsp.get_clients({ bufnr = buffer, name = "geotrace" })[1], {}
  local notify = client.notify
  client.notify = function(self, method, params)
    if method == "geotrace/cursor" then
      table.insert(told, params.position.line)
    end
    return notify(self, method, params)
  end
  vim.cmd("split | wincmd j")
  vim.api.nvim_win_set_cursor(0, { 3, 0 })
  vim.cmd.doautocmd("CursorMoved")
  eventually("the cursor", function()
    return #told > 0
  end)
  client.notify = nil
  vim.cmd.close()
  equal(told, { 2 })
end)

test("the health check bears a server that a function connects to", function()
  vim.lsp.config("geotrace", { cmd = function() end })
  vim.cmd("checkhealth geotrace")
  local report = text()
  assert(report:find("function", 1, true) and not report:find("ERROR", 1, true), report)
end)

suite:finish()
