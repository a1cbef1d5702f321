//! The languages and views of the command line, as a value: a test or another program may add its own.

use std::path::Path;
use std::sync::Arc;

use ide::Languages;
use ide::language::Language;
use render::view::Views;

use crate::failure::Failure;

/// The languages and views of a command line.
#[derive(Clone, Debug)]
pub struct Registry {
    /// The languages of programs; the extension of a file selects one of them.
    pub languages: Languages,
    /// The views of a program, for pictures and the window.
    pub views: Views,
}

impl Registry {
    /// Returns the languages and views of this program.
    pub fn standard() -> Self {
        Self {
            languages: Languages::standard(),
            views: Views::standard(),
        }
    }
}

/// The state that all commands of a run share.
#[derive(Clone, Debug)]
pub(crate) struct Context {
    /// The languages and views.
    pub(crate) registry: Registry,
    /// The name of the language of all programs; `None` if the extension of each file selects it.
    pub(crate) language: Option<String>,
}

impl Context {
    /// Returns the language of a program.
    ///
    /// # Errors
    /// [`Failure::Usage`] if there is no language of the given name.
    pub(crate) fn language(&self, path: &Path) -> Result<&Arc<dyn Language>, Failure> {
        match self.named()? {
            Some(language) => Ok(language),
            None => Ok(self.registry.languages.for_path(path)),
        }
    }

    /// Returns the languages of a window or an editor: all of them, or the given one.
    ///
    /// # Errors
    /// As [`Context::language`].
    pub(crate) fn languages(&self) -> Result<Languages, Failure> {
        Ok(match self.named()? {
            Some(language) => Languages::only(Arc::clone(language)),
            None => self.registry.languages.clone(),
        })
    }

    /// Returns the language of the given name, if one was given.
    fn named(&self) -> Result<Option<&Arc<dyn Language>>, Failure> {
        let languages = &self.registry.languages;
        let Some(name) = &self.language else {
            return Ok(None);
        };
        languages.named(name).map(Some).ok_or_else(|| {
            let known = languages.all().map(|known| format!("`{}`", known.name()));
            Failure::Usage {
                message: format!("--language: unknown language `{name}`"),
                hint: Some(format!(
                    "the languages are {}",
                    known.collect::<Vec<_>>().join(", ")
                )),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Context, Registry};
    use crate::failure::Failure;

    #[test]
    fn a_language_is_chosen_by_extension_or_by_name() {
        let context = |language: Option<&str>| Context {
            registry: Registry::standard(),
            language: language.map(str::to_owned),
        };
        let chosen = |language, path| {
            let context = context(language);
            context.language(Path::new(path)).map(|found| found.name())
        };
        assert!(chosen(None, "a.gtr").is_ok_and(|name| name == "geotrace"));
        assert!(chosen(None, "-").is_ok_and(|name| name == "geotrace"));
        assert!(chosen(Some("geotrace"), "a.txt").is_ok());
        assert!(matches!(
            chosen(Some("latin"), "a.gtr"),
            Err(Failure::Usage { .. })
        ));
        let all = context(None).languages();
        assert!(all.is_ok_and(|languages| languages.all().count() > 1));
        let one = context(Some("crt")).languages();
        assert!(one.is_ok_and(|languages| languages.default_language().name() == "crt"));
        assert!(context(Some("latin")).languages().is_err());
    }
}
