-- Files ending in .gtr are Geotrace programs, files ending in .crt scripts of the CRT scene language unless they are certificates.
vim.filetype.add({
  extension = {
    gtr = "geotrace",
    crt = function(_, buffer)
      -- A name that is matched alone comes with no buffer.
      local lines = vim.api.nvim_buf_is_valid(buffer) and vim.api.nvim_buf_get_lines(buffer, 0, 1, false) or {}
      local first = lines[1] or ""
      return not vim.startswith(first, "-----BEGIN") and "crt" or nil
    end,
  },
})
