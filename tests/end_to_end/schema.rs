//! The JSON of a diagnosis has the form that its published schema states: every value is checked, and every field is described.

use serde_json::Value;

use crate::diagnose_made::{Case, Motion, SHOULDER, trio};

/// A schema (JSON Schema 2020-12) with the definitions that it refers to. A keyword that is not known here is an error of the test.
struct Schema<'a> {
    root: &'a Value,
}

impl Schema<'_> {
    /// What in `value` is not as `schema` says, with its place.
    fn faults(&self, schema: &Value, value: &Value, place: &str) -> Vec<String> {
        if let Some(any) = schema.as_bool() {
            return if any { Vec::new() } else { vec![format!("{place}: not allowed")] };
        }
        let mut faults = Vec::new();
        let keywords = schema.as_object().expect("a schema is an object");
        for (keyword, argument) in keywords {
            match keyword.as_str() {
                "$ref" => faults.extend(self.faults(self.definition(argument), value, place)),
                "anyOf" | "oneOf" => {
                    let list = argument.as_array().expect("a list");
                    let fits = list.iter().filter(|one| self.faults(one, value, place).is_empty()).count();
                    if fits == 0 || (keyword == "oneOf" && fits > 1) {
                        faults.push(format!("{place}: {fits} of {keyword} fit {value}"));
                    }
                }
                "const" if argument != value => faults.push(format!("{place}: {value} instead of {argument}")),
                "enum" if !argument.as_array().expect("a list").contains(value) => {
                    faults.push(format!("{place}: {value} is none of {argument}"));
                }
                // A "const" or "enum" that comes to here holds; the others say nothing of the value.
                "const" | "enum" | "$schema" | "$defs" | "title" | "description" | "format" | "examples"
                | "default" => {}
                "type" => {
                    let is = |name: &Value| is_of_type(value, name.as_str().expect("a type"));
                    if !argument.as_array().map_or_else(|| is(argument), |list| list.iter().any(is)) {
                        faults.push(format!("{place}: {value} is no {argument}"));
                    }
                }
                "properties" => {
                    for (name, schema) in argument.as_object().expect("properties") {
                        if let Some(value) = value.get(name) {
                            faults.extend(self.faults(schema, value, &format!("{place}.{name}")));
                        }
                    }
                    // A field that the schema does not have is allowed to later programs, not to this one.
                    for name in value.as_object().into_iter().flat_map(|fields| fields.keys()) {
                        if argument.get(name).is_none() {
                            faults.push(format!("{place}.{name}: not in the schema"));
                        }
                    }
                }
                "required" => {
                    let missing = argument.as_array().expect("a list").iter().filter(|name| {
                        let name = name.as_str().expect("a name");
                        value.is_object() && value.get(name).is_none()
                    });
                    faults.extend(missing.map(|name| format!("{place}: {name} is missing")));
                }
                "additionalProperties" => {
                    for (name, value) in value.as_object().into_iter().flatten() {
                        faults.extend(self.faults(argument, value, &format!("{place}.{name}")));
                    }
                }
                "items" => {
                    for (k, value) in value.as_array().into_iter().flatten().enumerate() {
                        faults.extend(self.faults(argument, value, &format!("{place}[{k}]")));
                    }
                }
                "minItems" | "maxItems" => {
                    let (number, bound) = (value.as_array().map_or(0, Vec::len) as u64, argument.as_u64());
                    let bound = bound.expect("a number");
                    if value.is_array() && (number < bound) == (keyword == "minItems") && number != bound {
                        faults.push(format!("{place}: {number} items, {keyword} is {bound}"));
                    }
                }
                other => panic!("the schema has the keyword {other}, which this test does not know"),
            }
        }
        faults
    }

    fn definition(&self, reference: &Value) -> &Value {
        let name = reference.as_str().and_then(|path| path.strip_prefix("#/$defs/"));
        &self.root["$defs"][name.expect("a reference to a definition")]
    }
}

fn is_of_type(value: &Value, name: &str) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("{other} is no type"),
    }
}

fn published() -> Value {
    let path = crate::support::root().join("docs/diagnosis.schema.json");
    serde_json::from_str(&std::fs::read_to_string(path).expect("the schema is there")).expect("it is JSON")
}

fn faults(value: &Value) -> Vec<String> {
    let root = published();
    Schema { root: &root }.faults(&root, value, "")
}

/// Friction on the shoulder, and structure without a name on the turning column.
fn rich(motion: &Motion, tau: &mut [f64]) {
    let speed = motion.qd[SHOULDER];
    tau[SHOULDER] += 2.5 * speed.signum() + 1.8 * speed;
    tau[0] += 2.0 * (3.0 * motion.q[1]).sin() * (2.0 * motion.q[2]).cos();
}

#[test]
fn diagnoses_are_as_the_schema_says() {
    for (injected, further) in
        [(&rich as &dyn Fn(&Motion, &mut [f64]), &["--next", "next.toml"][..]), (&|_, _| {}, &[])]
    {
        let case = Case::new(&trio(), injected);
        let mut found = case.json(further);
        assert_eq!(faults(&found), Vec::<String>::new());
        assert_eq!(found["next_experiment"].is_object(), !further.is_empty());
        // The walk finds errors.
        found["verdict"] = "no idea".into();
        found["fit"]["elbow"]["noise"] = "loud".into();
        found["robot"].take();
        found.as_object_mut().expect("an object").remove("located");
        found["colour"] = 1.into();
        let said = faults(&found).join("\n");
        for place in [".verdict", ".fit.elbow.noise", ".robot", "\"located\" is missing", ".colour"] {
            assert!(said.contains(place), "{place} is not in {said}");
        }
    }
}

#[test]
fn every_field_has_a_description() {
    fn check(value: &Value, place: &str) {
        if let Some(properties) = value.get("properties").and_then(Value::as_object) {
            for (name, field) in properties {
                let place = format!("{place}.{name}");
                assert!(field.get("description").is_some_and(Value::is_string), "{place} has no description");
            }
        }
    }
    let root = published();
    check(&root, "");
    for (name, definition) in root["$defs"].as_object().expect("definitions") {
        assert!(definition["description"].is_string(), "{name} has no description");
        check(definition, name);
    }
}
