// Generated: stores the attributes of the faces that have list `list`, at a place of their coordinates. The numbers of
// their expressions begin at `instance`.
fn list_attributes(list: u32, x: Range, y: Range, z: Range, instance: u32) {
}
