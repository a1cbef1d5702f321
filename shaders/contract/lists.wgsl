// Generated: stores the attributes of the faces with list `list`, at a point in their coordinates. The numbers of their
// expressions begin at `instance`.
fn list_attributes(list: u32, x: Range, y: Range, z: Range, instance: u32) {
}
