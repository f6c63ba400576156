//! WGSL, which wgpu takes to Vulkan, Metal and Direct3D 12.

use super::writer::{Language, body, buffer_name};
use crate::record::{Access, Binary, Element, Kernel, Unary};
use std::fmt::Write;

struct Wgsl;

impl Language for Wgsl {
    fn constant(value: f32) -> String {
        format!("{value:e}f")
    }
    fn unary(operation: Unary) -> &'static str {
        match operation {
            Unary::Negate | Unary::Rounded => "",
            Unary::SquareRoot => "sqrt",
            Unary::InverseSquareRoot => "inverseSqrt",
            Unary::Absolute => "abs",
            Unary::Logarithm => "log",
            Unary::Exponential => "exp",
            Unary::Cosine => "cos",
        }
    }
    fn binary(operation: Binary) -> &'static str {
        match operation {
            Binary::Minimum => "min",
            Binary::Maximum => "max",
            Binary::Power => "pow",
            Binary::Add => "+",
            Binary::Subtract => "-",
            Binary::Multiply => "*",
            Binary::Divide => "/",
        }
    }
    const MULTIPLY_ADD: &'static str = "fma";
    fn select(a: &str, b: &str, then: &str, otherwise: &str) -> String {
        format!("select({otherwise}, {then}, {a} < {b})")
    }
    fn value(_element: Element) -> &'static str {
        "let"
    }
    const VARIABLE: &'static str = "var";
    const ENDLESS: &'static str = "loop";
    fn floor(number: &str) -> String {
        format!("bitcast<u32>(i32(floor({number})))")
    }
    fn rounded(number: &str) -> String {
        // Zero, which only the launch knows.
        format!("bitcast<f32>(bitcast<u32>({number}) ^ launch[2])")
    }
    fn number(whole: &str) -> String {
        format!("f32({whole})")
    }
    fn count(element: &str) -> String {
        format!("atomicAdd(&{element}, 1u)")
    }
    fn range(counter: &str, first: &str, end: &str) -> String {
        format!("for (var {counter} = {first}; {counter} < {end}; {counter}++)")
    }
}

/// Threads of a workgroup.
pub(crate) const WORKGROUP: u32 = 64;

/// A kernel in WGSL. Its buffers are bound in their order, and after them `launch`: number of threads, threads of a row of workgroups, zero.
pub fn wgsl(kernel: &Kernel) -> String {
    let mut text = String::new();
    for (k, buffer) in kernel.buffers.iter().enumerate() {
        let access = match buffer.access {
            Access::Read => "read",
            Access::Write => "read_write",
        };
        let element = match buffer.element {
            Element::Number => "f32",
            Element::Whole => "u32",
            Element::Counter => "atomic<u32>",
        };
        // Writing into a string cannot fail.
        let _ = writeln!(
            text,
            "@group(0) @binding({k}) var<storage, {access}> {}: array<{element}>; // {}",
            buffer_name(k),
            buffer.name
        );
    }
    let count = kernel.buffers.len();
    let _ = write!(
        text,
        "@group(0) @binding({count}) var<storage, read> launch: array<u32>;\n\n\
         @compute @workgroup_size({WORKGROUP})\n\
         fn {}(@builtin(global_invocation_id) place: vec3<u32>) {{\n    \
         let thread = place.y * launch[1] + place.x;\n    \
         if (thread >= launch[0]) {{ return; }}\n{}}}\n",
        kernel.name,
        body::<Wgsl>(kernel)
    );
    text
}
