-- What the commands do.
local M = {}

local function client(buffer)
  return vim.lsp.get_clients({ name = "geotrace", bufnr = buffer })[1]
end

-- Tells a server where the cursor of a window stands, for the preview: what is declared there is set off.
local function tell_cursor(running, window)
  running:notify("geotrace/cursor", vim.lsp.util.make_position_params(window, running.offset_encoding))
end

-- The preview of the current buffer: {}, {"3d"}, {"geodesic", NAME}, {"traced"} or {"traced", CAMERA}.
function M.preview(words)
  local running = client(0)
  if not running then
    vim.notify("Geotrace: the language server is not running; see :checkhealth geotrace", vim.log.levels.ERROR)
    return
  end
  local arguments = { vim.uri_from_bufnr(0) }
  if words[1] == "3d" then
    arguments[2] = { view = "3d" }
  elseif words[1] == "geodesic" then
    arguments[2] = { view = "geodesic", surface = words[2] }
  elseif words[1] == "traced" then
    arguments[2] = { view = "traced", surface = words[2] }
  elseif words[1] then
    vim.notify("Geotrace: a view is 3d, geodesic NAME, traced, or traced CAMERA", vim.log.levels.ERROR)
    return
  end
  -- It may not have moved since the buffer was opened.
  tell_cursor(running, 0)
  running:exec_cmd({ title = "Preview", command = "geotrace.preview", arguments = arguments }, { bufnr = 0 })
end

-- The names that may follow a view: those that one of these words declares in the current buffer.
local followers = { geodesic = { "surface", "metric", "solid" }, traced = { "camera" } }
local function declared(keywords)
  local running = client(0)
  local params = { textDocument = vim.lsp.util.make_text_document_params(0) }
  local answer = running and running:request_sync("textDocument/documentSymbol", params, 1000, 0)
  local names = {}
  for _, symbol in ipairs(answer and answer.result or {}) do
    local word = (symbol.detail or ""):match("^%a+")
    if vim.tbl_contains(keywords, word) then
      table.insert(names, symbol.name)
    end
  end
  return names
end

-- What the command for the preview may go on with.
function M.complete(lead, line, position)
  local words = vim.split(line:sub(1, position), "%s+", { trimempty = true })
  local before = #words - (lead == "" and 0 or 1)
  local keywords = before == 2 and followers[words[2]]
  local offered = before == 1 and { "3d", "geodesic", "traced" } or keywords and declared(keywords) or {}
  return vim.tbl_filter(function(name)
    return vim.startswith(name, lead)
  end, offered)
end

-- Tells the server where the cursor stands in a buffer whenever it has moved: at most one message in 30 ms, and the last
-- place always.
function M.follow_cursor(buffer)
  local waiting = false
  local function tell()
    waiting = false
    local running = vim.api.nvim_buf_is_loaded(buffer) and client(buffer)
    -- A buffer may be in several windows: the cursor that moved is that of the current one.
    local window = vim.api.nvim_get_current_win()
    if vim.api.nvim_win_get_buf(window) ~= buffer then
      window = vim.fn.bufwinid(buffer)
    end
    if running and window ~= -1 then
      tell_cursor(running, window)
    end
  end
  vim.api.nvim_create_autocmd({ "CursorMoved", "CursorMovedI" }, {
    group = vim.api.nvim_create_augroup("geotrace.cursor." .. buffer, {}),
    buffer = buffer,
    callback = function()
      if not waiting then
        waiting = true
        vim.defer_fn(tell, 30)
      end
    end,
  })
end

-- Restarts the server for all Geotrace buffers; starts one where it has ended by itself.
function M.restart()
  local running = vim.lsp.get_clients({ name = "geotrace", _uninitialized = true })
  local old = {}
  for _, each in ipairs(running) do
    old[tostring(each.id)] = true
    -- A server that is shutting down answers nothing: the buffers must not ask it any more.
    for _, buffer in ipairs(vim.tbl_keys(each.attached_buffers)) do
      vim.lsp.buf_detach_client(buffer, each.id)
    end
    each:stop()
  end
  local function have_ended()
    return vim.iter(running):all(function(each)
      return vim.lsp.get_client_by_id(each.id) == nil
    end)
  end
  if not vim.wait(3000, have_ended, 20) then
    for _, each in ipairs(running) do
      each:stop(true)
    end
    vim.wait(1000, have_ended, 20)
  end
  -- An answer about diagnostics that came after its buffer was detached: Neovim would show it for ever.
  for namespace, it in pairs(vim.diagnostic.get_namespaces()) do
    if old[it.name:match("lsp%.geotrace%.(%d+)")] then
      vim.diagnostic.reset(namespace)
    end
  end
  local config = vim.lsp.config.geotrace
  for _, buffer in ipairs(vim.api.nvim_list_bufs()) do
    local is_ours = vim.api.nvim_buf_is_loaded(buffer) and vim.tbl_contains(config.filetypes, vim.bo[buffer].filetype)
    if is_ours and vim.bo[buffer].buftype == "" then
      -- The markers alone are read by `vim.lsp.enable` only.
      local root = vim.fs.root(buffer, config.root_markers or {})
      vim.lsp.start(vim.tbl_extend("force", config, { root_dir = root }), { bufnr = buffer })
    end
  end
end

return M
