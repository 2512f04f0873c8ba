//! The text for the terminal is narrow and complete.

use diagnosis::NotDiagnosed;
use report::terminal;

use crate::made_up::{self, Plot};

#[test]
fn the_text_is_narrow_and_complete() {
    let (report, _, arm) = made_up::diagnosis(6, Plot::Rich);
    let text = terminal::complete(&report, &arm);
    println!("{text}");
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
    }
    for part in [
        "shoulder_lift_joint",
        "whole arm",
        "62.0 ± 3.1 N m/rad",
        "could also be payload",
        "next experiment: Sweep",
        "not testable with these recordings: ",
        "backlash on 6 joints",
        "position error over the joints: 21.0 → 1.16 mrad\n",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(text.starts_with("The model omits 8 effects on 4 joints and the whole arm. An unmodelled residual\n"));
}

#[test]
fn the_short_text_is_one_screen_with_at_most_three_next_steps() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    let short = terminal::diagnosis(&report);
    let steps = |text: &str| text.lines().filter(|line| line.starts_with("- ")).count();
    assert!((1..=4).contains(&steps(&short)), "{short}");
    assert!(short.contains("62.0 ± 3.1 N m/rad") && !short.contains("not testable"), "{short}");
    assert!(short.lines().count() <= 40, "{short}");
    // Joints with the same next experiment are one step; what exceeds three steps is counted.
    let open = report.unexplained[0].clone();
    report.unexplained = (0..5).map(|_| open.clone()).collect();
    let together = terminal::diagnosis(&report);
    assert!(together.contains("unexplained residuals; next experiment"), "{together}");
    for (k, open) in report.unexplained.iter_mut().enumerate() {
        open.next = format!("record {k} more");
    }
    let text = terminal::diagnosis(&report);
    assert!(steps(&text) == 4 && text.contains("more with --verbose"), "{text}");
}

/// Findings that one experiment distinguishes from the same alternatives are one step, and the table breaks no word.
#[test]
fn findings_with_the_same_alternatives_are_one_step() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    report.next_experiment = None;
    let is_ambiguous = |finding: &&diagnosis::Finding| finding.joint.is_some() && !finding.confusable_with.is_empty();
    let mut finding = report.findings.iter().find(is_ambiguous).expect("a finding has an alternative").clone();
    for other in &mut finding.confusable_with {
        other.joint = None;
    }
    let on = |joint: &str| diagnosis::Finding { joint: Some(joint.to_owned()), ..finding.clone() };
    report.findings = ["a_joint_with_a_very_long_name_indeed", "another_joint"].map(on).into();
    report.unexplained.truncate(1);
    report.unexplained[0].joint = "a_joint_with_a_very_long_name_indeed".to_owned();
    let text = terminal::diagnosis(&report);
    assert_eq!(text.matches("could also be").count(), 1, "{text}");
    assert!(text.contains("\n- a_joint_with_a_very_long_name_indeed and another_joint, "), "{text}");
    assert!(text.contains("unexplained "), "{text}");
}

/// Each alternative has the experiment for the pair, where there is one, and else that for the finding's effect.
#[test]
fn alternatives_have_their_own_experiments() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    let mut findings = report.findings.iter_mut();
    let finding = findings.find(|finding| !finding.confusable_with.is_empty());
    let finding = finding.expect("a finding has an alternative");
    finding.effect = "torque_offset";
    let mut experiments = |rivals: &[&'static str]| {
        let rival = |&effect: &&'static str| diagnosis::Confusable { effect, joint: None };
        finding.confusable_with = rivals.iter().map(rival).collect();
        report::words::experiments(finding)
    };
    let brake = "read the torque with the brake closed and no current: a torque offset persists, friction does not";
    assert_eq!(experiments(&["friction_asymmetry"]), brake);
    assert_eq!(experiments(&["payload", "gravity_misalignment"]), "static poses in several postures");
    let both = format!("{brake}; static poses in several postures");
    assert_eq!(experiments(&["friction_asymmetry", "payload"]), both);
    report.unexplained.clear();
    report.next_experiment = None;
    let text = terminal::diagnosis(&report);
    let text: Vec<&str> = text.split_whitespace().collect();
    let text = text.join(" ");
    assert!(text.contains(&both), "{text}");
}

#[test]
fn words_in_the_table_are_not_broken() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    let joint = "a_joint_with_a_name_of_more_than_forty_letters";
    for finding in report.findings.iter_mut().filter(|finding| finding.joint.is_some()) {
        finding.joint = Some(joint.to_owned());
    }
    let text = terminal::diagnosis(&report);
    assert!(text.contains(joint), "{text}");
    for finding in &report.findings {
        let title = effects::spec(finding.effect).map_or(finding.effect, |spec| spec.title);
        for word in title.split(' ') {
            assert!(text.split_whitespace().any(|found| found == word), "{word} is broken in\n{text}");
        }
    }
}

/// The table names a body that the URDF draws and the robot lacks in those words, not a payload.
#[test]
fn a_payload_of_negative_mass_is_a_tool_that_is_not_mounted() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    let text = terminal::diagnosis(&report);
    assert!(text.contains("payload") && !text.contains("mounted"), "{text}");
    let finding = report.findings.iter_mut().find(|finding| finding.effect == "payload");
    let finding = finding.expect("a payload");
    finding.as_effect = finding.as_effect.clone().with("mass", -0.9);
    assert_eq!(report::words::effect(finding), "tool not mounted");
    let text = terminal::diagnosis(&report);
    assert!(text.contains("mounted"), "{text}");
}

/// Joints without a usable torque are in the first sentence, with the reason below it, and no output counts them among the joints that
/// the model explains.
#[test]
fn joints_that_are_not_diagnosed_come_first() {
    let (mut report, traces, arm) = made_up::diagnosis(7, Plot::Clean);
    let joint = arm.joints()[2].name.clone();
    let strip = format!("Joint 3 · {joint}</h3>");
    let before = report::page(&report, &traces, &arm);
    assert!(before.contains(&strip), "the residual of a joint without findings is drawn");
    report.fit.remove(&joint);
    report.not_diagnosed.push(NotDiagnosed {
        joints: vec![joint.clone()],
        because: "the measured torque is almost constant".to_owned(),
    });
    let first = format!("{joint} was not diagnosed; everything else is about the other joints.");
    let reason = format!("{joint} is not diagnosed: the measured torque is almost constant.");
    let joined = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    for text in [terminal::diagnosis(&report), terminal::complete(&report, &arm)] {
        let text = joined(&text);
        assert!(text.starts_with(&first) && text.contains(&reason), "{text}");
    }
    let markdown = report::diagnosis_markdown(&report, &arm);
    let coded = reason.replacen(&joint, &format!("`{joint}`"), 1);
    assert!(markdown.contains(&format!("**{first}")) && markdown.contains(&coded), "{markdown}");
    let page = report::page(&report, &traces, &arm);
    assert!(page.contains(&format!("<h1>{first}")) && page.contains(&reason));
    assert!(!page.contains(&strip), "its residual is no error of the model");
}

#[test]
fn an_empty_diagnosis_has_no_table() {
    let (report, ..) = made_up::diagnosis(7, Plot::Clean);
    let text = terminal::diagnosis(&report);
    assert!(text.starts_with("The model explains the recordings") && !text.contains("share"));
    let (report, ..) = made_up::diagnosis(1, Plot::TooShort);
    assert!(terminal::diagnosis(&report).contains("not enough data: 1.9 s in motion"));
}

/// The effects of a hypothesis may make the error larger.
#[test]
fn an_error_that_grows_does_not_fall() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    report.verdict = diagnosis::Verdict::PartlyExplained;
    let said = |report: &mut diagnosis::Report, nominal: f64, augmented: f64| {
        for fit in report.fit.values_mut() {
            fit.held_out_nrmse_nominal = Some(nominal);
            fit.held_out_nrmse_augmented = Some(augmented);
        }
        report::words::verdict(report)
    };
    assert!(said(&mut report, 0.48, 0.59).contains("rises from 0.48 to 0.59 times"));
    assert!(said(&mut report, 0.59, 0.48).contains("only falls from 0.59 to 0.48 times"));
    assert!(said(&mut report, 0.48, 0.48).contains("remains 0.48 times"));
}

/// Without findings, the text says in which state and when the residual is largest.
#[test]
fn an_unexplained_mismatch_has_its_place_and_next_experiment() {
    let (mut report, _, arm) = made_up::diagnosis(6, Plot::Rich);
    report.findings.clear();
    report.verdict = diagnosis::Verdict::Unexplained;
    let joint = report.located[1].joint.clone();
    report.unexplained.truncate(1);
    report.unexplained[0].joint = joint.clone();
    report.unexplained[0].time = report.located[1].time.clone();
    let flat = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let short = flat(terminal::diagnosis(&report));
    for part in [
        &format!("The mismatch on {joint} is unexplained"),
        "largest: 11.2 to 12.8 s of recordings/a_sines.csv",
        "next experiment: Sweep this joint alone",
    ] {
        assert!(short.contains(part), "{part} is not in\n{short}");
    }
    let place =
        "largest: angle from -1.9 to -0.8 rad; speed below 0.05 rad/s; 11.2 to 12.8 s of recordings/a_sines.csv";
    let long = flat(terminal::complete(&report, &arm)).replace('−', "-");
    assert!(long.contains(place), "{long}");
    let markdown = report::diagnosis_markdown(&report, &arm).replace('−', "-");
    assert!(markdown.contains(place), "{markdown}");
}

#[test]
fn a_residual_above_the_torques_standard_deviation_is_not_a_percentage() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    report.unexplained[0].share = 3.21;
    let text = terminal::diagnosis(&report);
    assert!(text.contains("unexplained residual 3.2 times the torque's standard"), "{text}");
}

#[test]
fn the_first_sentence_states_little_explanation_and_missing_validation() {
    let (mut report, ..) = made_up::diagnosis(6, Plot::Rich);
    for fit in report.fit.values_mut() {
        fit.held_out_nrmse_nominal = Some(1.2);
        fit.held_out_nrmse_augmented = Some(0.9);
    }
    let text = terminal::diagnosis(&report);
    assert!(text.starts_with("Most of the mismatch is unexplained: "), "{text}");
    report.verdict = diagnosis::Verdict::Explained;
    let name = report.fit.keys().next().expect("a joint").clone();
    for (error, said) in [
        (0.45, format!("explains the recordings to within 0.45 times the torque's standard deviation ({name}).")),
        (
            0.95,
            format!("leaves a residual that looks like noise, of 0.95 times the torque's standard deviation ({name})."),
        ),
    ] {
        for fit in report.fit.values_mut() {
            fit.held_out_nrmse_augmented = Some(0.05);
        }
        report.fit.get_mut(&name).expect("it is there").held_out_nrmse_augmented = Some(error);
        let text = terminal::diagnosis(&report).replace(char::is_whitespace, "");
        assert!(text.contains(&said.replace(' ', "")), "{text}");
    }
    for fit in report.fit.values_mut() {
        fit.held_out_nrmse_augmented = Some(0.05);
    }
    let text = terminal::diagnosis(&report).replace('\n', " ");
    assert!(text.contains("the model explains the recordings. "), "{text}");
    report.recordings.held_out.clear();
    let text = terminal::diagnosis(&report);
    assert!(!text.contains("held-out recording") && text.contains("not validated"), "{text}");
}
