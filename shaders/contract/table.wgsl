// Called by the generated `evaluate`, defined in the pass that joins it: returns variable number `variable` of a row.
fn input_value(row: u32, variable: u32) -> f32 {
    return 0.0;
}

// Stores the result of root number `root` at a row.
fn store_output(row: u32, root: u32, value: f32) {
}
