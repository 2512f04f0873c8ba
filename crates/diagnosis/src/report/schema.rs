//! The JSON Schema of a diagnosis, made from the types that are serialised.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;

use super::Report;

/// The JSON Schema (draft 2020-12) of what `testbed diagnose --json` writes. Fields that are omitted where they are empty are not
/// required; further fields may be added in later versions of the program.
pub fn json_schema() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let settings = settings.with_transform(RecursiveTransform(in_words_of_json));
    settings.into_generator().into_root_schema_for::<Report>()
}

/// Replaces `None` by `null` in the descriptions, which are the types' documentation.
fn in_words_of_json(schema: &mut Schema) {
    if let Some(serde_json::Value::String(description)) = schema.get_mut("description") {
        *description = description.replace("`None`", "`null`");
    }
}
