//! CUDA C++, for NVIDIA GPUs where there is no Vulkan.

use super::writer::{Language, body, buffer_name};
use crate::record::{Access, Binary, Element, Kernel, Unary};

struct Cuda;

impl Language for Cuda {
    fn constant(value: f32) -> String {
        let text = format!("{value:e}");
        // `1e5f` is a number, `1f` would be none.
        format!("{text}f")
    }
    fn unary(operation: Unary) -> &'static str {
        match operation {
            Unary::Negate | Unary::Rounded => "",
            Unary::SquareRoot => "sqrtf",
            Unary::InverseSquareRoot => "rsqrtf",
            Unary::Absolute => "fabsf",
            Unary::Logarithm => "logf",
            Unary::Exponential => "expf",
            Unary::Cosine => "cosf",
        }
    }
    fn binary(operation: Binary) -> &'static str {
        match operation {
            Binary::Minimum => "fminf",
            Binary::Maximum => "fmaxf",
            Binary::Power => "powf",
            Binary::Add => "+",
            Binary::Subtract => "-",
            Binary::Multiply => "*",
            Binary::Divide => "/",
        }
    }
    const MULTIPLY_ADD: &'static str = "fmaf";
    fn select(a: &str, b: &str, then: &str, otherwise: &str) -> String {
        format!("{a} < {b} ? {then} : {otherwise}")
    }
    fn value(element: Element) -> &'static str {
        match element {
            Element::Number => "const float",
            Element::Whole | Element::Counter => "const unsigned",
        }
    }
    const VARIABLE: &'static str = "float";
    const ENDLESS: &'static str = "for (;;)";
    fn floor(number: &str) -> String {
        format!("(unsigned)(int)floorf({number})")
    }
    fn rounded(number: &str) -> String {
        // Without fast maths this compiler takes numbers for what they are.
        number.to_owned()
    }
    fn number(whole: &str) -> String {
        format!("(float){whole}")
    }
    fn count(element: &str) -> String {
        format!("atomicAdd(&{element}, 1u)")
    }
    fn range(counter: &str, first: &str, end: &str) -> String {
        format!("for (unsigned {counter} = {first}; {counter} < {end}; ++{counter})")
    }
}

/// A kernel in CUDA C++. Its arguments are its buffers in their order, and the number of threads.
pub fn cuda(kernel: &Kernel) -> String {
    let mut arguments = String::new();
    for (k, buffer) in kernel.buffers.iter().enumerate() {
        let access = match buffer.access {
            Access::Read => "const ",
            Access::Write => "",
        };
        let element = match buffer.element {
            Element::Number => "float",
            Element::Whole | Element::Counter => "unsigned",
        };
        arguments += &format!("    {access}{element}* __restrict__ {}, // {}\n", buffer_name(k), buffer.name);
    }
    format!(
        "extern \"C\" __global__ void {}(\n{arguments}    unsigned threads\n) {{\n    \
         const unsigned thread = blockIdx.x * blockDim.x + threadIdx.x;\n    \
         if (thread >= threads) {{ return; }}\n{}}}\n",
        kernel.name,
        body::<Cuda>(kernel)
    )
}
