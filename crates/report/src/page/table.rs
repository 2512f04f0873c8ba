//! Tables that become lists of cards on a narrow screen.

use maud::{Markup, html};

/// A column: its title, and whether it holds numbers.
#[derive(Clone, Copy)]
pub struct Column<'a> {
    title: &'a str,
    is_number: bool,
}

/// A column of words.
pub const fn words(title: &str) -> Column<'_> {
    Column { title, is_number: false }
}

/// A column of numbers.
pub const fn number(title: &str) -> Column<'_> {
    Column { title, is_number: true }
}

/// A table as of [`table`](table()), with compact cards on a narrow screen: the cells after the third one continue its
/// line.
pub fn brief_table(columns: &[Column<'_>], rows: Vec<Vec<Markup>>) -> Markup {
    html! { div.brief { (table(columns, rows)) } }
}

/// A table; every row has one cell per column. On a narrow screen, a row is a card that the first cell heads.
pub fn table(columns: &[Column<'_>], rows: Vec<Vec<Markup>>) -> Markup {
    html! {
        div.scroll { table.cards {
            thead { tr { @for column in columns { th class=[class(column)] scope="col" { (column.title) } } } }
            tbody { @for row in rows { tr {
                @for (column, cell) in columns.iter().zip(row) {
                    td class=[class(column)] data-title=(column.title) { span { (cell) } }
                }
            } } }
        } }
    }
}

fn class(column: &Column<'_>) -> Option<&'static str> {
    column.is_number.then_some("n")
}

/// The number of characters from which a name may be broken into lines.
const LONG: usize = 18;

/// A long name, which may be broken after its underscores, slashes and dots.
pub fn name(text: &str) -> Markup {
    html! {
        @if text.chars().count() < LONG { (text) } @else {
            @for part in text.split_inclusive(['_', '/', '\\', '.']) { (part) wbr; }
        }
    }
}
