-- Comments, and words as the language has them.
vim.bo.commentstring = "-- %s"
vim.bo.comments = ":--"
vim.bo.iskeyword = "a-z,A-Z,48-57"
vim.b.undo_ftplugin = "setlocal commentstring< comments< iskeyword<"
