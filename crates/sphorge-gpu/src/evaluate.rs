//! Recorded kernels executed one thread after the other, in memory: what a GPU has to do.

use crate::record::{Binary, Kernel, Operation, Statement, Unary, Value};
use std::collections::HashMap;

/// Elements of a buffer, whole numbers as their bits.
pub(crate) type Contents = Vec<f32>;

/// What threads have chosen so far: of each branch and choice, whether it fell this way and that; and how operations round.
#[derive(Default)]
pub(crate) struct Evaluation {
    choices: HashMap<(Value, Value), [bool; 2]>,
    rounding: Option<Rounding>,
}

/// Operations that round at random.
struct Rounding {
    state: u64,
    units: Units,
}

/// Units of the last place by which operations round otherwise.
#[derive(Clone, Copy)]
pub(crate) struct Units {
    pub(crate) of_sums_and_products: i32,
    pub(crate) of_quotients_and_functions: i32,
}

impl Units {
    fn of(self, operation: Operation) -> i32 {
        match operation {
            Operation::MultiplyAdd(..) | Operation::Binary(Binary::Add | Binary::Subtract | Binary::Multiply, ..) => {
                self.of_sums_and_products
            }
            Operation::Binary(Binary::Divide | Binary::Power, ..) => self.of_quotients_and_functions,
            Operation::Unary(Unary::Negate | Unary::Rounded | Unary::Absolute, _) => 0,
            Operation::Unary(..) => self.of_quotients_and_functions,
            _ => 0,
        }
    }
}

impl Rounding {
    fn of(&mut self, number: f32, units: i32) -> f32 {
        if units == 0 || number == 0.0 || !number.is_finite() {
            return number;
        }
        // A generator of Lehmer.
        self.state = self.state * 48_271 % 2_147_483_647;
        let off = (self.state % (2 * units as u64 + 1)) as i32 - units;
        let moved = f32::from_bits(number.to_bits().wrapping_add_signed(off));
        if moved.is_finite() && moved.is_sign_negative() == number.is_sign_negative() { moved } else { number }
    }
}

impl Evaluation {
    /// Operations round at random, by up to so many units; another number gives others.
    pub(crate) fn rounding_at_random(units: Units, number: u32) -> Self {
        let state = (u64::from(number) + 1) * 48_271 % 2_147_483_647;
        Self { rounding: Some(Rounding { state, units }), ..Self::default() }
    }

    /// Runs `threads` threads over the buffers of a kernel.
    pub(crate) fn run(&mut self, kernel: &Kernel, buffers: &mut [Contents], threads: u32) {
        self.run_some(kernel, buffers, 0..threads);
    }

    /// The same of some threads.
    pub(crate) fn run_some(&mut self, kernel: &Kernel, buffers: &mut [Contents], threads: std::ops::Range<u32>) {
        assert_eq!(buffers.len(), kernel.buffers.len());
        let mut state = State {
            kernel,
            buffers,
            thread: 0,
            values: vec![0; kernel.operations.len()],
            variables: Vec::new(),
            choices: &mut self.choices,
            rounding: &mut self.rounding,
        };
        for thread in threads {
            state.thread = thread;
            state.run(&kernel.statements);
        }
    }

    /// What was compared where a choice always fell the same way.
    pub(crate) fn one_way(&self, kernel: &Kernel) -> Vec<(Operation, Operation)> {
        let one_way = self.choices.iter().filter(|(_, taken)| **taken != [true; 2]);
        one_way.map(|((a, b), _)| (kernel.operations[*a as usize], kernel.operations[*b as usize])).collect()
    }
}

struct State<'a> {
    kernel: &'a Kernel,
    buffers: &'a mut [Contents],
    thread: u32,
    values: Vec<u32>,
    variables: Vec<u32>,
    choices: &'a mut HashMap<(Value, Value), [bool; 2]>,
    rounding: &'a mut Option<Rounding>,
}

impl State<'_> {
    fn number(&self, value: Value) -> f32 {
        f32::from_bits(self.values[value as usize])
    }

    /// Whether `a < b`, kept in mind.
    fn less(&mut self, a: Value, b: Value) -> bool {
        let less = self.number(a) < self.number(b);
        self.choices.entry((a, b)).or_default()[usize::from(less)] = true;
        less
    }

    fn run(&mut self, statements: &[Statement]) {
        for statement in statements {
            match statement {
                Statement::Let(value) => {
                    let result = self.operation(*value);
                    self.values[*value as usize] = result;
                }
                Statement::Declare { variable, start: value } | Statement::Assign { variable, value } => {
                    let variable = *variable as usize;
                    self.variables.resize(self.variables.len().max(variable + 1), 0);
                    self.variables[variable] = self.values[*value as usize];
                }
                Statement::Store { buffer, at, value } => {
                    let at = self.values[*at as usize] as usize;
                    self.buffers[*buffer as usize][at] = self.number(*value);
                }
                Statement::Count { result, buffer, at } => {
                    let at = self.values[*at as usize] as usize;
                    let element = &mut self.buffers[*buffer as usize][at];
                    self.values[*result as usize] = element.to_bits();
                    *element = f32::from_bits(element.to_bits() + 1);
                }
                Statement::If { a, b, then, otherwise } => {
                    let chosen = if self.less(*a, *b) { then } else { otherwise };
                    self.run(chosen);
                }
                Statement::Loop { body, again } => loop {
                    self.run(body);
                    if self.number(*again) > 0.0 {
                        continue;
                    }
                    break;
                },
                Statement::Range { counter, first, end, body } => {
                    for index in self.values[*first as usize]..self.values[*end as usize] {
                        self.values[*counter as usize] = index;
                        self.run(body);
                    }
                }
            }
        }
    }

    fn operation(&mut self, value: Value) -> u32 {
        if let Operation::SelectLess(a, b, then, otherwise) = self.kernel.operations[value as usize] {
            let chosen = if self.less(a, b) { then } else { otherwise };
            return self.values[chosen as usize];
        }
        let values = &self.values;
        let of = |value: Value| f32::from_bits(values[value as usize]);
        let whole = |value: Value| values[value as usize];
        let number = match self.kernel.operations[value as usize] {
            Operation::Constant(bits) => return bits,
            Operation::Whole(value) => return value,
            Operation::Thread => return self.thread,
            Operation::Counter(_) | Operation::Counted(_) => return whole(value),
            Operation::WholeAdd(a, b) => return whole(a).wrapping_add(whole(b)),
            Operation::WholeMultiply(a, b) => return whole(a) * whole(b),
            Operation::WholeAnd(a, b) => return whole(a) & whole(b),
            Operation::Floor(a) => return of(a).floor() as i32 as u32,
            Operation::Number(a) => whole(a) as f32,
            Operation::Read(variable, _) => return self.variables[variable as usize],
            Operation::Load(buffer, at) | Operation::LoadNow(buffer, at, _) => {
                self.buffers[buffer as usize][whole(at) as usize]
            }
            Operation::Unary(operation, a) => match operation {
                Unary::Negate => -of(a),
                Unary::Rounded => of(a),
                Unary::SquareRoot => of(a).sqrt(),
                Unary::InverseSquareRoot => 1.0 / of(a).sqrt(),
                Unary::Absolute => of(a).abs(),
                Unary::Logarithm => of(a).ln(),
                Unary::Exponential => of(a).exp(),
                Unary::Cosine => of(a).cos(),
            },
            Operation::Binary(operation, a, b) => match operation {
                Binary::Add => of(a) + of(b),
                Binary::Subtract => of(a) - of(b),
                Binary::Multiply => of(a) * of(b),
                Binary::Divide => of(a) / of(b),
                Binary::Minimum => sphorge_physics::Real::min(of(a), of(b)),
                Binary::Maximum => sphorge_physics::Real::max(of(a), of(b)),
                Binary::Power => of(a).powf(of(b)),
            },
            // As the laws do on a processor.
            Operation::MultiplyAdd(a, b, c) => {
                let product = of(a) * of(b);
                let of_product = |rounding: &mut Rounding| rounding.of(product, rounding.units.of_sums_and_products);
                self.rounding.as_mut().map_or(product, of_product) + of(c)
            }
            Operation::SelectLess(..) => unreachable!("chosen above"),
        };
        let operation = self.kernel.operations[value as usize];
        self.rounding.as_mut().map_or(number, |rounding| rounding.of(number, rounding.units.of(operation))).to_bits()
    }
}

/// Whole numbers as the contents of a buffer.
pub(crate) fn whole(values: &[u32]) -> Contents {
    values.iter().map(|value| f32::from_bits(*value)).collect()
}
