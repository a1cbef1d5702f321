// Runs in the extension host: every test of `tests.js`, or of the file that GEOTRACE_SUITE names.
const { runAll } = require("./runner");

exports.run = () => runAll(require(process.env.GEOTRACE_SUITE ?? "./tests"));
