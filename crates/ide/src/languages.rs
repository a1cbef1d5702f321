//! The languages that the program knows, as a value: tests and other programs can add their own.

use std::path::Path;
use std::sync::Arc;

use crate::crt::Crt;
use crate::geotrace::Geotrace;
use crate::language::Language;

/// A list of languages; cheap to clone.
#[derive(Clone, Debug)]
pub struct Languages {
    standard: Arc<dyn Language>,
    others: Vec<Arc<dyn Language>>,
}

impl Languages {
    /// Returns the languages of this program: Geotrace and CRT.
    pub fn standard() -> Self {
        Self {
            standard: Arc::new(Geotrace),
            others: vec![Arc::new(Crt)],
        }
    }

    /// Returns the languages with an additional one.
    #[must_use]
    pub fn with(mut self, language: impl Language + 'static) -> Self {
        self.others.push(Arc::new(language));
        self
    }

    /// Returns a list of one language for all files, whatever their extensions.
    pub fn only(language: Arc<dyn Language>) -> Self {
        Self {
            standard: language,
            others: Vec::new(),
        }
    }

    /// Returns all languages, in the order in which they were added.
    pub fn all(&self) -> impl Iterator<Item = &Arc<dyn Language>> {
        std::iter::once(&self.standard).chain(&self.others)
    }

    /// Returns the language of texts without an extension, such as standard input.
    pub fn default_language(&self) -> &Arc<dyn Language> {
        &self.standard
    }

    /// Returns the language with a name used by editors.
    pub fn named(&self, name: &str) -> Option<&Arc<dyn Language>> {
        self.all().find(|language| language.name() == name)
    }

    /// Returns the language of a file's extension, ignoring case.
    pub fn by_extension(&self, path: &Path) -> Option<&Arc<dyn Language>> {
        let extension = path.extension()?.to_str()?;
        self.all().find(|language| {
            let mut known = language.extensions().iter();
            known.any(|known| known.eq_ignore_ascii_case(extension))
        })
    }

    /// Returns the language of a file by its extension, or else the default.
    pub fn for_path(&self, path: &Path) -> &Arc<dyn Language> {
        self.by_extension(path).unwrap_or(&self.standard)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::Languages;

    #[test]
    fn a_file_without_a_known_extension_is_a_geotrace_program() {
        let languages = Languages::standard();
        for path in ["a.gtr", "a.txt", "-", "gtr", ".gtr"] {
            let language = languages.for_path(Path::new(path));
            assert_eq!(language.name(), "geotrace", "{path}");
        }
        assert!(languages.by_extension(Path::new("a.gtr")).is_some());
        assert!(languages.by_extension(Path::new("a.txt")).is_none());
        assert!(languages.named("plaintext").is_none());
        for path in ["a.crt", "A.CRT"] {
            let script = languages.by_extension(Path::new(path));
            assert!(script.is_some_and(|language| language.name() == "crt"));
        }
    }
}
