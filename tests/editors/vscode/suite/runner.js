// Runs tests one after the other, and says how each went.
exports.runAll = async (tests) => {
    let failed = 0;
    const names = Object.keys(tests);
    for (const name of names) {
        try {
            await tests[name]();
            console.log(`ok      ${name}`);
        } catch (error) {
            failed += 1;
            console.log(`FAILED  ${name}\n${error.stack}`);
        }
    }
    console.log(`VS Code: ${names.length - failed} passed, ${failed} failed`);
    if (failed > 0 || names.length === 0) {
        throw new Error(`${failed} of ${names.length} tests failed`);
    }
};
