//! The report as Markdown, of which the page for a browser is made.

use super::{
    Effort,
    number::significant,
    report::{CaseReport, Report, RunEntry},
    text::{finding_rows, study_rows},
};
use std::fmt::Write;

impl Report {
    /// The report as Markdown, with pictures by relative links.
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        let effort = match self.effort {
            Effort::Quick => "low resolution (`--quick`)",
            Effort::Full => "full resolution",
        };
        let outcome = match self.cases.len() {
            computed if computed < self.asked => format!("**Not finished: {computed} of {} cases.**", self.asked),
            _ if self.passed => format!("**All cases passed{}.**", self.known_misses()),
            _ => "**Not all cases passed.**".to_owned(),
        };
        text += &format!(
            "# Validation of Sphorge {}\n\n{outcome} Computed at {effort} in {:.0} s on {}.\n\n",
            self.version, self.seconds, self.machine
        );
        text += "| case | what | verdict | checks passed |\n|---|---|---|---|\n";
        for case in &self.cases {
            let ((passed, asked), missed) = (case.checks(), case.missed_in_words());
            let (name, verdict) = (case.name, case.verdict.name());
            text += &format!("| [{name}](#{name}) | {} | {verdict} | {passed} of {asked}{missed} |\n", case.title);
        }
        for case in &self.cases {
            text.push('\n');
            case.write_markdown(&mut text);
        }
        text
    }
}

impl CaseReport {
    fn write_markdown(&self, text: &mut String) {
        *text += &format!("## {}\n\n{}. {}\n\n", self.name, self.title, self.about);
        for run in &self.runs {
            if let Some(failure) = &run.failure {
                *text += &format!("Run `{}` **failed**: {failure}\n\n", run.label);
            }
            for warning in &run.unexpected_warnings {
                *text += &format!("Run `{}` is **broken**: {warning}\n\n", run.label);
            }
        }
        for table in &self.tables {
            let heads = table.head.len();
            *text +=
                &format!("{}:\n\n| {} |\n|---{}|\n", table.title, table.head.join(" | "), "|---:".repeat(heads - 1));
            for row in &table.rows {
                *text += &format!("| {} |\n", row.join(" | "));
            }
            text.push('\n');
        }
        if !self.findings.is_empty() {
            *text += "| quantity | run | ours | reference | deviation | tolerance | verdict |\n";
            *text += "|---|---|---:|---|---:|---|---|\n";
            rows(text, self.findings.iter().flat_map(finding_rows));
            let mut told: Vec<(&str, &str)> = Vec::new();
            let reasons = self.findings.iter().filter_map(|f| Some((f.quantity.as_str(), f.tolerance.as_ref()?)));
            for (quantity, tolerance) in reasons {
                // Once for all runs.
                if told.contains(&(quantity, &tolerance.reason)) {
                    continue;
                }
                *text += if told.is_empty() { "\nWhy these tolerances:\n\n" } else { "" };
                *text += &format!("- {quantity}: {}\n", tolerance.reason);
                told.push((quantity, &tolerance.reason));
            }
            text.push('\n');
        }
        if !self.studies.is_empty() {
            *text += "| against spacing | run | ours | exact | error | order | verdict |\n";
            *text += "|---|---|---:|---:|---:|---:|---|\n";
            rows(text, self.studies.iter().flat_map(study_rows));
            for study in &self.studies {
                if let Some(demand) = &study.demand {
                    *text += &format!("\n- {}: {}", study.quantity, demand.reason);
                }
            }
            *text += "\n\n";
        }
        for note in &self.notes {
            *text += &format!("{note}\n\n");
        }
        for (name, reason) in &self.expected_warnings {
            *text += &format!("The warning `{name}` is expected: {reason}.\n\n");
        }
        for picture in &self.pictures {
            match (&picture.file, &picture.trouble) {
                (Some(file), _) => *text += &format!("![{}]({file})\n\n{}\n\n", picture.caption, picture.caption),
                (None, trouble) => {
                    let trouble = trouble.as_deref().unwrap_or_default();
                    *text += &format!("No picture of {}: {trouble}\n\n", picture.caption);
                }
            }
        }
        *text += "| run | particles | steps | seconds | largest energy drift | largest momentum drift | command |\n";
        *text += "|---|---:|---:|---:|---:|---:|---|\n";
        for run in &self.runs {
            let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), significant);
            let count = |value: Option<u64>| value.map_or_else(|| "-".to_owned(), |v| v.to_string());
            *text += &format!(
                "| [{}]({}) | {} | {} | {} | {} | {} | `{}` |\n",
                run.label,
                run.folder,
                count(run.particles),
                count(run.steps),
                run.seconds.map_or_else(|| "-".to_owned(), |s| format!("{s:.1}")),
                number(run.energy_drift),
                number(run.momentum_drift),
                command(self.deck, run),
            );
        }
    }
}

fn rows(text: &mut String, rows: impl Iterator<Item = [String; 7]>) {
    for row in rows {
        *text += &format!("| {} |\n", row.join(" | "));
    }
}

/// What to type to repeat a run.
fn command(deck: &str, run: &RunEntry) -> String {
    let mut command = format!("sphorge run {deck}");
    for (path, value) in &run.overrides {
        // Writing to a string does not fail.
        let _ = write!(command, " --set {path}='{value}'");
    }
    command
}
