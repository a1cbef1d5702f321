//! The names of keys in words. Menus and lists use those of most keyboards; a Mac has others.

use egui::Context;

/// Returns the names of keys, or a sentence that contains some, as used by the window's system: on a Mac, Ctrl is Cmd
/// and Alt is Option.
pub(crate) fn named(context: &Context, keys: &str) -> String {
    if context.os().is_mac() {
        keys.replace("Ctrl", "Cmd").replace("Alt", "Option")
    } else {
        keys.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use egui::os::OperatingSystem;

    #[test]
    fn a_mac_has_its_own_keys() {
        let context = egui::Context::default();
        for (system, keys) in [
            (OperatingSystem::Mac, "Cmd+Shift+C, Option and click"),
            (OperatingSystem::Windows, "Ctrl+Shift+C, Alt and click"),
        ] {
            context.set_os(system);
            let named = super::named(&context, "Ctrl+Shift+C, Alt and click");
            assert_eq!(named, keys);
        }
    }
}
