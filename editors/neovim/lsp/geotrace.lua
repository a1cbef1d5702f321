-- The language server's configuration; `vim.lsp.enable("geotrace")` starts it for Geotrace and CRT files (Neovim 0.11 and newer).
-- Another program:  vim.lsp.config("geotrace", { cmd = { "/where/it/is/geotrace", "lsp" } })
-- The preview with each file:  vim.lsp.config("geotrace", { settings = { geotrace = { preview = { open = "onOpen" } } } })
-- After each picture of the preview the autocommand `User GeotraceShown` is run, with { uri, version, ok, milliseconds } as
-- its data.
return {
  cmd = { "geotrace", "lsp" },
  filetypes = { "geotrace", "crt" },
  root_markers = { ".git" },
  -- The server answers faster than a key repeats: nothing is gained by waiting.
  flags = { debounce_text_changes = 10 },
  capabilities = { experimental = { geotrace = { shown = true } } },
  handlers = {
    ["geotrace/shown"] = function(_, shown)
      vim.api.nvim_exec_autocmds("User", { pattern = "GeotraceShown", data = shown })
    end,
  },
}
