-- :GeotracePreview [3d | inside NAME], :GeotraceRestart.
if vim.g.loaded_geotrace then
  return
end
vim.g.loaded_geotrace = true

vim.api.nvim_create_user_command("GeotracePreview", function(command)
  require("geotrace").preview(command.fargs)
end, {
  nargs = "*",
  desc = "Open the preview of this document",
  complete = function()
    return { "3d", "inside" }
  end,
})

vim.api.nvim_create_user_command("GeotraceRestart", function()
  require("geotrace").restart()
end, { desc = "Start Geotrace's language server anew" })
