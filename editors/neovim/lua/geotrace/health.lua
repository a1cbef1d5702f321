-- :checkhealth geotrace
local M = {}

-- The version that this plugin is made for.
M.version = "0.1"

function M.check()
  local health = vim.health
  health.start("geotrace")
  if vim.fn.has("nvim-0.11") == 0 then
    health.error("Neovim 0.11 or newer is needed for vim.lsp.config")
    return
  end
  local config = vim.lsp.config.geotrace
  if not config then
    health.error("no configuration of the server", "put editors/neovim on 'runtimepath'")
    return
  end
  if vim.lsp.is_enabled and not vim.lsp.is_enabled("geotrace") then
    health.warn("the server is not enabled", 'add vim.lsp.enable("geotrace") to your configuration')
  end
  M.check_program(config.cmd)
  local running = vim.lsp.get_clients({ name = "geotrace" })
  if #running > 0 then
    health.ok(("%d server running, position encoding %s"):format(#running, running[1].offset_encoding))
  else
    health.info("no server runs: open a .gtr file")
  end
end

-- Whether the program is there, in the version that this plugin is made for.
function M.check_program(cmd)
  local health = vim.health
  if type(cmd) == "function" then
    health.info("a function of your configuration connects to the server, so its version is not checked")
    return
  end
  local program = cmd[1]
  if vim.fn.executable(program) == 0 then
    health.error(
      ("the program %s was not found"):format(program),
      { "cargo install --locked --path crates/cli", 'vim.lsp.config("geotrace", { cmd = { "/where/it/is/geotrace", "lsp" } })' }
    )
    return
  end
  local run = vim.system({ program, "--version" }, { text = true }):wait(10000)
  local version = run.code == 0 and run.stdout:match("^geotrace (%S+)")
  if not version then
    health.error(program .. " --version does not report a version: " .. (run.stderr or ""))
  elseif version:match("^%d+%.%d+") ~= M.version then
    health.warn(
      ("%s is geotrace %s, this plugin requires %s"):format(program, version, M.version),
      "install the same version of both"
    )
  else
    health.ok(("%s, version %s"):format(vim.fn.exepath(program), version))
  end
end

return M
