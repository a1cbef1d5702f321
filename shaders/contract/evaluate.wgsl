// Generated: evaluates expressions at one row of inputs, and passes each result to `store_output`.
fn evaluate(row: u32) {
}
