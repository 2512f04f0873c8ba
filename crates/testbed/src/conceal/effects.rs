//! The effects to inject as a TOML file: the file of a diagnosis, in which an effect may also have an onset and a form.

use std::path::Path;

use anyhow::{Context, anyhow};
use arm::Arm;
use faults::{Injected, form_parameters, more_parameters};

use study::Source;
use study::effect_file;

/// Reads the effects at `path`, which must fit `arm`.
///
/// # Errors
/// With file, line, reason and remedy.
pub fn load(path: &Path, arm: &Arm) -> anyhow::Result<Vec<Injected>> {
    let text = std::fs::read_to_string(path)
        .with_context(|| format!("{}: the effects cannot be read; give a .toml file of effects", path.display()))?;
    let source = Source { name: String::new(), path: path.to_owned(), text };
    let (_, tables) = effect_file::tables(&source, arm)?;
    let mut effects = Vec::new();
    for table in tables {
        let span = table.span();
        let fail = |reason: String| anyhow!("{}: {reason}", source.place(span.clone()));
        let mut table = table.into_inner();
        // JSON has no such numbers and would omit the key.
        if let Some((key, value)) = table.iter().find(|(_, value)| value.as_float().is_some_and(|v| !v.is_finite())) {
            return Err(fail(format!("{key} is {value}; give a number")));
        }
        let json = serde_json::to_value(&table).map_err(|error| fail(error.to_string()))?;
        let effect: Injected = serde_json::from_value(json).map_err(|error| fail(error.to_string()))?;
        if !faults::is_outside(&effect.effect) {
            // Keys that the catalogue does not have belong to this command; the others are checked as for any effect.
            let spec = effects::CATALOGUE.iter().find(|spec| spec.name == effect.effect);
            let is_own = |key: &&&str| spec.is_none_or(|spec| spec.parameters.iter().all(|known| known.key != **key));
            for key in form_parameters(&effect.effect).iter().filter(is_own) {
                if table.remove(*key).is_some() && effect.form.is_none() {
                    return Err(fail(format!(
                        "{}: {key} belongs to a form; add form = \"…\" (docs/conceal.md lists them), or leave {key} out",
                        effect.effect
                    )));
                }
            }
            for key in ["onset", "form"].iter().chain(more_parameters(&effect.effect)) {
                table.remove(*key);
            }
            if effect.is_not_mounted() {
                // The drawn body is checked, which has the opposite sign.
                for key in ["mass", "inertia"] {
                    if let Some(value) = table.get_mut(key) {
                        negate(value);
                    }
                }
            }
            effect_file::effect(&source, span.clone(), table, arm)?;
        }
        effect.check(arm).map_err(|error| fail(error.to_string()))?;
        effects.push(effect);
    }
    Ok(effects)
}

/// Multiplies a number, or each number of a list, by −1. Any other value is unchanged and is refused later.
fn negate(value: &mut toml::Value) {
    match value {
        toml::Value::Float(number) => *number = -*number,
        toml::Value::Integer(number) => *number = -*number,
        toml::Value::Array(list) => list.iter_mut().for_each(negate),
        _ => {}
    }
}
