-- A user's whole configuration: our folder on the runtime path, and the server enabled.
vim.opt.runtimepath:prepend(vim.env.GEOTRACE_ROOT .. "/editors/neovim")
vim.opt.swapfile = false
vim.lsp.enable("geotrace")
