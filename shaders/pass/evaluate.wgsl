// Evaluates expressions over rows of inputs, for the GPU's results as numbers.

struct Table {
    rows: u32,
    variables: u32,
    uniforms: u32,
    roots: u32,
}

@group(0) @binding(0) var<uniform> table: Table;
// Row by row: the variables, then the uniforms.
@group(0) @binding(1) var<storage, read> inputs: array<f32>;
@group(0) @binding(2) var<storage, read_write> outputs: array<f32>;

fn input_value(row: u32, variable: u32) -> f32 {
    return inputs[row * (table.variables + table.uniforms) + variable];
}

fn uniform_value(instance: u32, slot: u32) -> f32 {
    return inputs[instance * (table.variables + table.uniforms) + table.variables + slot];
}

fn store_output(row: u32, root: u32, value: f32) {
    outputs[row * table.roots + root] = value;
}

@compute @workgroup_size(64)
fn evaluate_rows(
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let row = flat_index(workgroup, workgroups, local);
    if row < table.rows {
        evaluate(row);
    }
}
