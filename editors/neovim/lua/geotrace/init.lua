-- What the commands do.
local M = {}

local function client(buffer)
  return vim.lsp.get_clients({ name = "geotrace", bufnr = buffer })[1]
end

-- The preview of the current buffer: {}, {"3d"} or {"inside", NAME}.
function M.preview(words)
  local running = client(0)
  if not running then
    vim.notify("Geotrace: the language server does not run here; :checkhealth geotrace says why", vim.log.levels.ERROR)
    return
  end
  local arguments = { vim.uri_from_bufnr(0) }
  if words[1] == "3d" then
    arguments[2] = { view = "3d" }
  elseif words[1] == "inside" then
    arguments[2] = { view = "geodesic", surface = words[2] }
  elseif words[1] then
    vim.notify("Geotrace: a view is 3d, or inside NAME", vim.log.levels.ERROR)
    return
  end
  running:exec_cmd({ title = "Preview", command = "geotrace.preview", arguments = arguments }, { bufnr = 0 })
end

-- Tells the server where the cursor stands in a buffer, for the preview: what is declared there is set off. At most one
-- message in 30 ms, and the last place always.
function M.follow_cursor(buffer)
  local waiting = false
  local function tell()
    waiting = false
    local running = vim.api.nvim_buf_is_loaded(buffer) and client(buffer)
    local window = vim.fn.bufwinid(buffer)
    if running and window ~= -1 then
      running:notify("geotrace/cursor", vim.lsp.util.make_position_params(window, running.offset_encoding))
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

-- Stops the server and starts it anew for all Geotrace buffers.
function M.restart()
  local running = vim.lsp.get_clients({ name = "geotrace" })
  local buffers = {}
  for _, each in ipairs(running) do
    for buffer in pairs(each.attached_buffers) do
      buffers[buffer] = true
    end
    -- A server that is shutting down answers nothing: the buffers must not ask it any more.
    for buffer in pairs(buffers) do
      vim.lsp.buf_detach_client(buffer, each.id)
    end
    each:stop()
  end
  vim.wait(3000, function()
    return #vim.lsp.get_clients({ name = "geotrace" }) == 0
  end, 20)
  local config = vim.lsp.config.geotrace
  for buffer in pairs(buffers) do
    vim.lsp.start(config, { bufnr = buffer })
  end
end

return M
