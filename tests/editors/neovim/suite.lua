-- Tests that a Neovim runs in itself: one line for each, and an exit status that is 0 only if all passed.
local Suite = {}
Suite.__index = Suite

local function say(text)
  io.stdout:write(text .. "\n")
end

-- A suite of this name, whose lines begin with `prefix`; conditions have `patience` milliseconds, and are looked at again
-- after every `step`.
function Suite.new(name, prefix, patience, step)
  return setmetatable({ name = name, prefix = prefix, patience = patience, step = step, passed = 0, failed = 0 }, Suite)
end

function Suite:test(name, body)
  local ok, problem = xpcall(body, debug.traceback)
  if ok then
    self.passed = self.passed + 1
    say("ok      " .. self.prefix .. name)
  else
    self.failed = self.failed + 1
    say("FAILED  " .. self.prefix .. name .. "\n" .. problem)
  end
end

-- Waits until the condition gives a value.
function Suite:eventually(what, condition)
  local value
  local ok = vim.wait(self.patience, function()
    value = condition()
    return value
  end, self.step)
  assert(ok, "never came: " .. what)
  return value
end

-- Says how it went and ends Neovim.
function Suite:finish()
  say(("%s: %d passed, %d failed"):format(self.name, self.passed, self.failed))
  vim.cmd((self.failed > 0 or self.passed == 0) and "cquit! 1" or "qall!")
end

return Suite
