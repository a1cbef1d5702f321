-- The preview as a user of Neovim meets it: the real window on a display of the test's own, driven by xdotool, and looked
-- at by screenshots. The exit status is 0 only if all passed.
--
-- GEOTRACE_REPORT is where the window leaves its counters, GEOTRACE_SCRATCH a folder for files and screenshots.
local scratch, report_file = vim.env.GEOTRACE_SCRATCH, vim.env.GEOTRACE_REPORT

-- The first frame may take a software driver long.
local suite = dofile(vim.env.GEOTRACE_ROOT .. "/tests/editors/neovim/suite.lua").new("Neovim's preview", "Neovim: ", 60000, 20)

local function test(name, body)
  suite:test(name, body)
end

local function eventually(what, condition)
  return suite:eventually(what, condition)
end

local function run(...)
  local done = vim.system({ ... }, { text = true }):wait(30000)
  assert(done.code == 0, table.concat({ ... }, " ") .. ": " .. (done.stderr or ""))
  return vim.trim(done.stdout)
end

-- The window's counters as it left them last.
local function report()
  local file = io.open(report_file)
  if not file then
    return nil
  end
  local last
  for line in file:lines() do
    local ok, value = pcall(vim.json.decode, line)
    last = ok and value or last
  end
  file:close()
  return last
end

local shown, messages = {}, {}
vim.api.nvim_create_autocmd("User", {
  pattern = "GeotraceShown",
  callback = function(event)
    table.insert(shown, event.data)
  end,
})
vim.lsp.handlers["window/showMessage"] = function(_, params)
  table.insert(messages, params.message)
end

-- Waits for the picture of the buffer as it is now.
local function picture()
  local version = function()
    return vim.lsp.util.buf_versions[vim.api.nvim_get_current_buf()]
  end
  return eventually("a picture; said was " .. vim.inspect(messages), function()
    local last = shown[#shown]
    return last and last.version == version() and last
  end)
end

-- The window's process: the server has the same words in its command line, but not first.
local function process()
  local found = vim.system({ "pgrep", "-f", "--", "^[^ ]+ preview --attached --report " .. report_file }, { text = true })
  return found:wait().stdout:match("%d+")
end

local function screenshot(name)
  -- All views have been drawn when the window draws itself no more.
  local frames
  eventually("rest", function()
    local before = frames
    vim.wait(500)
    frames = report().frames
    return frames == before
  end)
  local path = ("%s/neovim-%s.png"):format(scratch, name)
  run("import", "-window", "root", path)
  return path
end

-- How many pixels differ.
local function difference(one, other)
  local done = vim.system({ "compare", "-metric", "AE", one, other, "null:" }, { text = true }):wait(30000)
  return tonumber(done.stderr:match("^[%d.e+]+"))
end

local path = scratch .. "/neovim.gtr"
local program = {
  "# seen from Neovim",
  "param neovim : [0.4, 0.9];",
  "surface s(u,v) = ((1 + neovim cos v) cos u, (1 + neovim cos v) sin u, neovim sin v),",
  "    u : [0, 2pi], v : [0, 2pi];",
}
vim.fn.writefile(program, path)
vim.cmd.edit(path)
local client = eventually("the server", function()
  local found = vim.lsp.get_clients({ bufnr = 0, name = "geotrace" })[1]
  return found and found.initialized and found
end)

local first
test("the command opens the window with the program's picture", function()
  vim.cmd.GeotracePreview()
  assert(picture().ok)
  eventually("its params", function()
    local counters = report()
    return counters and counters.params.neovim
  end)
  first = screenshot("first")
end)

test("what is typed changes the picture", function()
  vim.api.nvim_buf_set_text(0, 2, 19, 2, 20, { "2" })
  assert(picture().ok)
  local second = screenshot("typed")
  assert(difference(first, second) > 1000, "the picture is the same")
  vim.cmd.undo()
  assert(picture().ok)
end)

test("a mistake keeps the picture and marks it", function()
  local before = screenshot("before-mistake")
  vim.api.nvim_buf_set_text(0, 2, 19, 2, 20, { "nothing" })
  assert(not picture().ok)
  eventually("the badge", function()
    return report().stale
  end)
  local broken = screenshot("mistake")
  assert(difference(before, broken) > 100, "nothing tells of the mistake")
  vim.cmd.undo()
  assert(picture().ok)
  eventually("no badge", function()
    return not report().stale
  end)
end)

test("a double click on an object jumps to its declaration", function()
  vim.api.nvim_win_set_cursor(0, { 1, 0 })
  local window = run("xdotool", "search", "--onlyvisible", "--class", "geotrace"):match("%d+")
  local places = {}
  for name, place in pairs(report().panes) do
    table.insert(places, { name, place })
  end
  assert(#places > 0, "no pane is told of")
  table.sort(places, function(a, b)
    return a[1] < b[1]
  end)
  local left, top, width, height = unpack(places[1][2])
  -- The torus is seen as a ring: its nearer side is below the middle.
  for _, down in ipairs({ 0.62, 0.7, 0.55, 0.8, 0.5 }) do
    local x, y = math.floor(left + width / 2), math.floor(top + height * down)
    run("xdotool", "mousemove", "--window", window, tostring(x), tostring(y))
    run("xdotool", "click", "--repeat", "2", "--delay", "60", "1")
    local jumped = vim.wait(3000, function()
      return vim.api.nvim_win_get_cursor(0)[1] == 3
    end, 20)
    if jumped then
      assert(vim.api.nvim_win_get_cursor(0)[2] == 8, vim.inspect(vim.api.nvim_win_get_cursor(0)))
      return
    end
  end
  screenshot("no-jump")
  error("the cursor stays: " .. vim.inspect(report().panes) .. vim.inspect(messages))
end)

test("values of params are hints behind their declarations", function()
  local params = {
    textDocument = vim.lsp.util.make_text_document_params(0),
    range = { start = { line = 0, character = 0 }, ["end"] = { line = 4, character = 0 } },
  }
  eventually("the hint", function()
    local answer = client:request_sync("textDocument/inlayHint", params, 8000, 0)
    for _, hint in ipairs(answer and answer.result or {}) do
      if hint.position.line == 1 and hint.label == "= 0.4" then
        return true
      end
    end
  end)
end)

test("a file that is read again is shown in the window that is there", function()
  local before = process()
  for _, least in ipairs({ 0.6, 0.4 }) do
    vim.fn.writefile(vim.tbl_map(function(line)
      return (line:gsub("%[0.4", "[" .. least))
    end, program), path)
    vim.cmd("edit!")
    eventually("the new text", function()
      return report().params.neovim[1] == least
    end)
    -- It had the time to close, if it had been told to.
    vim.wait(1500)
    assert(process() == before, "it is another window, or none")
  end
end)

test("a view of no surface is answered with a sentence", function()
  messages = {}
  vim.cmd.GeotracePreview("geodesic", "nosuch")
  eventually("the message", function()
    return messages[1] == "There is no surface, metric or solid `nosuch`: the program has s."
  end)
end)

test("a window that is killed is told of, and the command opens it anew", function()
  messages = {}
  run("kill", "-9", process())
  eventually("the message", function()
    return messages[1] and messages[1]:find("signal: 9", 1, true)
  end)
  shown = {}
  vim.cmd.GeotracePreview()
  assert(picture().ok)
end)

test("the window closes with the editor's goodbye", function()
  client:stop()
  eventually("the end of the window", function()
    return not process()
  end)
end)

-- Whether it closes then is looked at when Neovim has ended: see `run`.
test("a window is open when Neovim ends", function()
  vim.cmd.edit()
  eventually("another server", function()
    local found = vim.lsp.get_clients({ bufnr = 0, name = "geotrace" })[1]
    return found and found.id ~= client.id and found.initialized
  end)
  shown = {}
  vim.cmd.GeotracePreview()
  assert(picture().ok and process())
end)

suite:finish()
