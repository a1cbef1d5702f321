-- The language server's configuration; `vim.lsp.enable("geotrace")` starts it for Geotrace files (Neovim 0.11 and newer).
-- Another program:  vim.lsp.config("geotrace", { cmd = { "/where/it/is/geotrace", "lsp" } })
return {
  cmd = { "geotrace", "lsp" },
  filetypes = { "geotrace" },
  root_markers = { ".git" },
  -- The server answers faster than a key repeats: nothing is gained by waiting.
  flags = { debounce_text_changes = 10 },
}
