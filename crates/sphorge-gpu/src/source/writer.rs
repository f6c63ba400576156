//! What the languages of GPUs have in common: all of them look like C.

use crate::record::{Binary, Element, Kernel, Operation, Statement, Unary, Value};
use std::fmt::Write;

/// Where two languages differ.
pub(super) trait Language {
    /// A constant number.
    fn constant(value: f32) -> String;
    /// A function of one number; not of the negation, which is an operator, nor of [`Unary::Rounded`].
    fn unary(operation: Unary) -> &'static str;
    /// A function of two numbers; not of the four operators.
    fn binary(operation: Binary) -> &'static str;
    /// `a * b + c` in one operation.
    const MULTIPLY_ADD: &'static str;
    /// `then` where `a < b`.
    fn select(a: &str, b: &str, then: &str, otherwise: &str) -> String;
    /// Start of the definition of a value.
    fn value(element: Element) -> &'static str;
    /// Start of the definition of a variable.
    const VARIABLE: &'static str;
    /// Start of a loop without end.
    const ENDLESS: &'static str;
    /// The largest whole number not above a number, as an unsigned one.
    fn floor(number: &str) -> String;
    /// A number whose origin the compiler does not see.
    fn rounded(number: &str) -> String;
    /// A whole number as a number.
    fn number(whole: &str) -> String;
    /// Adds one to an element of a buffer of counters.
    fn count(element: &str) -> String;
    /// Head of a loop over a range.
    fn range(counter: &str, first: &str, end: &str) -> String;
}

/// Writes the statements of a kernel.
pub(super) fn body<L: Language>(kernel: &Kernel) -> String {
    let mut writer = Writer { kernel, text: String::new(), depth: 1 };
    writer.statements::<L>(&kernel.statements);
    writer.text
}

/// Name of a buffer in a text.
pub(super) fn buffer_name(index: usize) -> String {
    format!("buffer_{index}")
}

struct Writer<'a> {
    kernel: &'a Kernel,
    text: String,
    depth: usize,
}

impl Writer<'_> {
    fn line(&mut self, line: &str) {
        let indent = 4 * self.depth;
        // Writing into a string cannot fail.
        let _ = writeln!(self.text, "{:indent$}{line}", "");
    }

    fn block<L: Language>(&mut self, head: &str, statements: &[Statement], last: Option<String>) {
        self.line(&format!("{head} {{"));
        self.depth += 1;
        self.statements::<L>(statements);
        if let Some(last) = last {
            self.line(&last);
        }
        self.depth -= 1;
        self.line("}");
    }

    fn statements<L: Language>(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                // Written where they are used.
                Statement::Let(value) if self.is_short(*value) => {}
                Statement::Let(value) => {
                    let line =
                        format!("{} v{value} = {};", L::value(self.element(*value)), self.operation::<L>(*value));
                    self.line(&line);
                }
                Statement::Declare { variable, start } => {
                    let line = format!("{} x{variable} = {};", L::VARIABLE, self.value::<L>(*start));
                    self.line(&line);
                }
                Statement::Assign { variable, value } => {
                    let line = format!("x{variable} = {};", self.value::<L>(*value));
                    self.line(&line);
                }
                Statement::Store { buffer, at, value } => {
                    let buffer = buffer_name(*buffer as usize);
                    let line = format!("{buffer}[{}] = {};", self.value::<L>(*at), self.value::<L>(*value));
                    self.line(&line);
                }
                Statement::Count { result, buffer, at } => {
                    let element = format!("{}[{}]", buffer_name(*buffer as usize), self.value::<L>(*at));
                    let line = format!("{} v{result} = {};", L::value(Element::Whole), L::count(&element));
                    self.line(&line);
                }
                Statement::If { a, b, then, otherwise } => {
                    let head = format!("if ({} < {})", self.value::<L>(*a), self.value::<L>(*b));
                    self.block::<L>(&head, then, None);
                    if !otherwise.is_empty() {
                        self.block::<L>("else", otherwise, None);
                    }
                }
                Statement::Loop { body, again } => {
                    let last = format!("if (!({} > {})) {{ break; }}", self.value::<L>(*again), L::constant(0.0));
                    self.block::<L>(L::ENDLESS, body, Some(last));
                }
                Statement::Range { counter, first, end, body } => {
                    let head = L::range(&format!("v{counter}"), &self.value::<L>(*first), &self.value::<L>(*end));
                    self.block::<L>(&head, body, None);
                }
            }
        }
    }

    fn is_short(&self, value: Value) -> bool {
        matches!(
            self.kernel.operations[value as usize],
            Operation::Constant(_) | Operation::Whole(_) | Operation::Thread
        )
    }

    fn value<L: Language>(&self, value: Value) -> String {
        if self.is_short(value) { self.operation::<L>(value) } else { format!("v{value}") }
    }

    fn operation<L: Language>(&self, value: Value) -> String {
        let of = |value: Value| self.value::<L>(value);
        match self.kernel.operations[value as usize] {
            Operation::Constant(bits) => L::constant(f32::from_bits(bits)),
            Operation::Whole(value) => format!("{value}u"),
            Operation::Thread => "thread".to_owned(),
            Operation::Counter(_) | Operation::Counted(_) => format!("v{value}"),
            Operation::Unary(Unary::Negate, a) => format!("-{}", of(a)),
            Operation::Unary(Unary::Rounded, a) => L::rounded(&of(a)),
            Operation::Unary(operation, a) => format!("{}({})", L::unary(operation), of(a)),
            Operation::Binary(operation, a, b) => {
                let operator = match operation {
                    Binary::Add => "+",
                    Binary::Subtract => "-",
                    Binary::Multiply => "*",
                    Binary::Divide => "/",
                    Binary::Minimum | Binary::Maximum | Binary::Power => {
                        return format!("{}({}, {})", L::binary(operation), of(a), of(b));
                    }
                };
                format!("{} {operator} {}", of(a), of(b))
            }
            Operation::MultiplyAdd(a, b, c) => format!("{}({}, {}, {})", L::MULTIPLY_ADD, of(a), of(b), of(c)),
            Operation::SelectLess(a, b, then, otherwise) => L::select(&of(a), &of(b), &of(then), &of(otherwise)),
            Operation::WholeAdd(a, b) => format!("{} + {}", of(a), of(b)),
            Operation::WholeMultiply(a, b) => format!("{} * {}", of(a), of(b)),
            Operation::WholeAnd(a, b) => format!("{} & {}", of(a), of(b)),
            Operation::Floor(a) => L::floor(&of(a)),
            Operation::Number(a) => L::number(&of(a)),
            Operation::Read(variable, _) => format!("x{variable}"),
            Operation::Load(buffer, at) | Operation::LoadNow(buffer, at, _) => {
                format!("{}[{}]", buffer_name(buffer as usize), of(at))
            }
        }
    }

    fn element(&self, value: Value) -> Element {
        match self.kernel.operations[value as usize] {
            Operation::Whole(_)
            | Operation::Thread
            | Operation::Counter(_)
            | Operation::Counted(_)
            | Operation::Floor(_)
            | Operation::WholeAnd(..)
            | Operation::WholeAdd(..)
            | Operation::WholeMultiply(..) => Element::Whole,
            Operation::Load(buffer, _) | Operation::LoadNow(buffer, ..) => self.kernel.buffers[buffer as usize].element,
            Operation::Constant(_)
            | Operation::Number(_)
            | Operation::Unary(..)
            | Operation::Binary(..)
            | Operation::MultiplyAdd(..)
            | Operation::SelectLess(..)
            | Operation::Read(..) => Element::Number,
        }
    }
}
