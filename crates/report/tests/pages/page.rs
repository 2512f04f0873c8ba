//! The page is self-contained, escapes names, and can be made of any diagnosis.

use diagnosis::{Traces, Verdict};

use crate::made_up::{self, Plot};

fn page(joints: usize, plot: Plot) -> String {
    let (report, traces, arm) = made_up::diagnosis(joints, plot);
    report::page(&report, &traces, &arm)
}

#[test]
fn the_page_is_self_contained_and_complete() {
    let text = page(7, Plot::Rich);
    // The library's licence and address are comments in its script.
    let (own, scripts) = text.split_at(text.find("<script>").expect("the page has scripts"));
    for foreign in ["http:", "https:", "src=", "url(", "@import", "<link"] {
        assert!(!own.contains(foreign), "the page has {foreign}");
    }
    assert!(scripts.contains("Copyright (c) 2022 Leon Sorokin"));
    assert!(own.contains("default-src 'none'"));
    for part in [
        "The model omits 8 effects",
        "shoulder_lift_joint",
        "62.0 ± 3.1 N m/rad",
        "could also be",
        "Sweep this joint alone",
        "Not testable with these recordings",
        "c_held_out.csv",
        "six &amp; one",
        env!("CARGO_PKG_VERSION"),
    ] {
        assert!(text.contains(part), "{part} is not in the page");
    }
    assert!(text.len() < 2_000_000, "{} bytes", text.len());
    assert!(!own.contains("NaN") && !own.contains("inf "));
}

#[test]
fn a_lag_that_was_removed_is_stated() {
    let (mut report, traces, arm) = made_up::diagnosis(3, Plot::Rich);
    for (lag, said) in [(0.0185, "18.5 ms later than"), (-0.004, "4.0 ms earlier than")] {
        report.torque_lag = Some(lag);
        for text in [report::page(&report, &traces, &arm), report::diagnosis_markdown(&report, &arm)] {
            assert!(text.contains(said), "{said}");
        }
    }
}

/// The verb of the first sentence agrees with the errors as they are rounded in it.
#[test]
fn the_first_sentence_agrees_with_its_numbers() {
    let lead = |errors: &[[f64; 2]]| {
        let (mut report, traces, arm) = made_up::diagnosis(errors.len(), Plot::Rich);
        report.located.clear();
        for (fit, [before, after]) in report.fit.values_mut().zip(errors) {
            (fit.held_out_nrmse_nominal, fit.held_out_nrmse_augmented) = (Some(*before), Some(*after));
        }
        let text = report::page(&report, &traces, &arm);
        let lead = text.split("<p class=\"lead\">").nth(1).and_then(|rest| rest.split("</p>").next());
        lead.expect("it has a first sentence").replace("<b>", "").replace("</b>", "")
    };
    let torque = "times the torque's standard deviation";
    let median = "(median over the joints with a model error).";
    let text = lead(&[[0.8, 0.1], [0.2, 0.1], [0.6, 0.3], [0.4, 0.05]]);
    assert!(text.ends_with(&format!("falls from 0.50 to 0.10 {torque} {median}")), "{text}");
    // Most joints are unchanged, and one is better.
    let text = lead(&[[0.25, 0.25], [0.25, 0.25], [0.9, 0.26]]);
    let one =
        format!("falls from 0.90 to 0.26 {torque}, more than that of any other joint; the median over the joints");
    assert!(text.contains(&one) && !text.contains("0.25 to 0.25"), "{text}");
    assert!(text.ends_with("with a model error remains 0.25."), "{text}");
    let text = lead(&[[0.25, 0.2501], [0.25, 0.2499]]);
    assert!(text.ends_with(&format!("the RMS torque error remains 0.25 {torque} {median}")), "{text}");
    let text = lead(&[[0.25, 0.25]]);
    assert!(text.ends_with(&format!("remains 0.25 {torque}.")), "{text}");
}

/// With recordings from before, the page begins with what changed.
#[test]
fn what_changed_comes_first() {
    let (mut report, traces, arm) = made_up::diagnosis(2, Plot::Rich);
    let mut first = |changed: Option<Vec<String>>| {
        report.changed = changed;
        let text = report::page(&report, &traces, &arm);
        let (before, _) = text.split_once("<h1>").expect("the page has a headline");
        before.to_owned()
    };
    let new = "joint <a>: a spring, absent in the recordings from before".to_owned();
    let said =
        "Changed since the recordings from before: joint &lt;a&gt;: a spring, absent in the recordings from before.";
    assert!(first(Some(vec![new])).contains(said));
    assert!(first(Some(Vec::new())).contains("Since the recordings from before, no change was found.</p>"));
    assert!(!first(None).contains("Since the recordings"));
}

/// A load is a supposition where most of the mismatch is unexplained.
#[test]
fn a_load_beside_an_unexplained_mismatch_is_a_supposition() {
    let (mut report, traces, arm) = made_up::diagnosis(2, Plot::Rich);
    let more_than_others = diagnosis::Parameter { value: 1.0, ci95: [0.9, 1.1], unit: "kg" };
    let recordings = vec![report.recordings.train[0].clone()];
    report.different_load = Some(diagnosis::DifferentLoad { recordings, more_than_others, until: None });
    let page = report::page(&report, &traces, &arm);
    assert!(page.contains(" was made with 1.00 ± 0.10 kg more at the tip than the other"));
    report.verdict = Verdict::Unexplained;
    let page = report::page(&report, &traces, &arm);
    assert!(page.contains(" seems to have been made with 1.00 ± 0.10 kg more at the tip than the other"));
    assert!(page.contains("check what the arm held"));
    report.different_load.as_mut().expect("it was set").until = Some(12.0);
    let page = report::page(&report, &traces, &arm);
    assert!(
        page.contains("more at the tip than later, until 12.00 s on the common clock. This is taken into account, but")
    );
    // A torque that looks like noise is not unexplained, however large it is.
    report.verdict = Verdict::NoMismatch;
    report.fit.values_mut().for_each(|fit| fit.held_out_nrmse_augmented = Some(0.9));
    assert!(report::page(&report, &traces, &arm).contains(" was made with 1.00 ± 0.10 kg more"));
}

/// An unexplained residual may hide a change, and without enough data nothing can be compared.
#[test]
fn that_nothing_changed_is_said_as_far_as_it_would_show() {
    let (mut report, traces, arm) = made_up::diagnosis(7, Plot::Rich);
    report.changed = Some(Vec::new());
    let open = report.unexplained[0].joint.clone();
    report.unexplained.truncate(1);
    let text = report::page(&report, &traces, &arm);
    let expected = format!("no change was found. The unexplained residual on {open} may hide one.");
    assert!(text.contains(&expected), "{expected}");
    report.verdict = Verdict::NotEnoughData;
    assert!(!report::page(&report, &traces, &arm).contains("no change was found"));
}

#[test]
fn the_contents_lead_to_every_section() {
    let text = page(7, Plot::Rich);
    let (contents, rest) = text.split_once("</nav>").expect("the page has contents");
    let links: Vec<&str> =
        contents.split("<li><a href=\"#").skip(1).filter_map(|link| link.split('"').next()).collect();
    let headings: Vec<&str> = rest.split("<h2 id=\"").skip(1).filter_map(|heading| heading.split('"').next()).collect();
    assert!(links.len() > 8, "{links:?}");
    assert_eq!(links, headings);
    let place = |id: &str| headings.iter().position(|heading| *heading == id);
    assert!(place("next") < place("joint-1"), "what to do next comes before the details");
}

/// Every zoomable drawing has its data: as many values as positions, and no figure is empty.
#[test]
fn figures_have_their_data() {
    let text = page(7, Plot::Rich);
    let data = text.split("<script type=\"application/json\">").skip(1);
    let mut count = 0;
    for part in data {
        let (json, _) = part.split_once("</script>").expect("the script ends");
        let data: serde_json::Value = serde_json::from_str(json).expect("it is JSON");
        let places = data["places"].as_array().expect("places");
        assert!(places.len() > 8);
        // Positions never decrease.
        assert!(places.iter().skip(1).all(|step| step.as_i64() >= Some(0)));
        for series in data["series"].as_array().expect("series") {
            let values = series["values"].as_array().expect("values");
            assert_eq!(values.len(), places.len());
            assert!(values.iter().any(serde_json::Value::is_number));
        }
        count += 1;
    }
    assert_eq!(count, text.matches("<div class=\"zoomable\">").count());
    assert!(count > 10, "{count}");
}

#[test]
fn names_are_escaped() {
    let text = page(7, Plot::Rich);
    assert!(!text.contains("<b>tool") && text.contains("&lt;b&gt;tool &amp; swivel&lt;/b&gt;"));
}

#[test]
fn the_same_diagnosis_gives_the_same_bytes() {
    assert_eq!(page(6, Plot::Rich), page(6, Plot::Rich));
}

/// Labels in the picture of the arm lead to the joints' sections, where there are any.
#[test]
fn every_link_leads_somewhere() {
    for plot in [Plot::Clean, Plot::Rich, Plot::TooShort] {
        let text = page(6, plot);
        let targets = |before: &str| -> Vec<String> {
            let parts = text.split(before).skip(1);
            parts.filter_map(|part| part.split('"').next()).map(str::to_owned).collect()
        };
        let ids = targets(" id=\"");
        let links = targets("href=\"#");
        assert!(!links.is_empty());
        for link in links {
            assert!(ids.contains(&link), "#{link} leads nowhere");
        }
    }
}

#[test]
fn any_arm_and_any_verdict_make_a_page() {
    for joints in 1..=7 {
        for plot in [Plot::Clean, Plot::Rich, Plot::TooShort] {
            let text = page(joints, plot);
            assert!(text.starts_with("<!DOCTYPE html>") && text.ends_with("</html>"));
        }
    }
    let (report, _, arm) = made_up::diagnosis(3, Plot::Rich);
    let text = report::page(&report, &Traces::default(), &arm);
    assert!(text.contains("elbow_joint"));
}
