-- Files ending in .gtr are Geotrace programs.
vim.filetype.add({ extension = { gtr = "geotrace" } })
