-- :GeotracePreview [3d | geodesic NAME | traced [CAMERA]], :GeotraceRestart.
if vim.g.loaded_geotrace then
  return
end
vim.g.loaded_geotrace = true

vim.api.nvim_create_user_command("GeotracePreview", function(command)
  require("geotrace").preview(command.fargs)
end, {
  nargs = "*",
  desc = "Open the preview of this document",
  complete = function(...)
    return require("geotrace").complete(...)
  end,
})

vim.api.nvim_create_autocmd("LspAttach", {
  group = vim.api.nvim_create_augroup("geotrace", {}),
  callback = function(event)
    local client = vim.lsp.get_client_by_id(event.data.client_id)
    if client and client.name == "geotrace" then
      require("geotrace").follow_cursor(event.buf)
    end
  end,
})

vim.api.nvim_create_user_command("GeotraceRestart", function()
  require("geotrace").restart()
end, { desc = "Restart Geotrace's language server" })
