//! Python's `math` module.

use super::Fault;
use super::value::Value;

pub(super) const CONSTANTS: &[(&str, f64)] = &[
    ("pi", std::f64::consts::PI),
    ("e", std::f64::consts::E),
    ("tau", std::f64::consts::TAU),
    ("inf", f64::INFINITY),
    ("nan", f64::NAN),
];

/// Names of the functions, in alphabetical order.
pub(super) const FUNCTIONS: &[&str] = &[
    "acos",
    "acosh",
    "asin",
    "asinh",
    "atan",
    "atan2",
    "atanh",
    "ceil",
    "copysign",
    "cos",
    "cosh",
    "degrees",
    "exp",
    "expm1",
    "fabs",
    "factorial",
    "floor",
    "fmod",
    "gcd",
    "hypot",
    "isclose",
    "isfinite",
    "isinf",
    "isnan",
    "log",
    "log10",
    "log1p",
    "log2",
    "pow",
    "radians",
    "sin",
    "sinh",
    "sqrt",
    "tan",
    "tanh",
    "trunc",
];

/// Calls the function `name` of [`FUNCTIONS`].
pub(super) fn call(name: &'static str, arguments: &[Value]) -> Result<Value, Fault> {
    match name {
        "atan2" | "copysign" | "fmod" | "pow" => {
            let [a, b] = numbers(arguments)?;
            two(name, a, b)
        }
        "hypot" => {
            let squares = arguments.iter().map(|value| number(value).map(|x| x * x));
            Ok(Value::Float(squares.sum::<Result<f64, _>>()?.sqrt()))
        }
        "gcd" | "factorial" => integers(name, arguments),
        "isclose" => {
            let [a, b] = numbers(arguments)?;
            Ok(Value::Bool(a == b || (a - b).abs() <= 1e-9 * a.abs().max(b.abs())))
        }
        "log" if arguments.len() == 2 => {
            let [x, base] = numbers(arguments)?;
            if x <= 0.0 || base <= 0.0 || base == 1.0 {
                return Err(domain(x));
            }
            Ok(Value::Float(x.ln() / base.ln()))
        }
        "ceil" | "floor" | "trunc" => {
            let [value] = exactly(arguments)?;
            if let Some(integer) = value.as_integer() {
                return Ok(Value::Integer(integer));
            }
            let value = number(value)?;
            rounded(match name {
                "ceil" => value.ceil(),
                "floor" => value.floor(),
                _ => value.trunc(),
            })
        }
        "isfinite" | "isinf" | "isnan" => {
            let [value] = numbers(arguments)?;
            Ok(Value::Bool(match name {
                "isfinite" => value.is_finite(),
                "isinf" => value.is_infinite(),
                _ => value.is_nan(),
            }))
        }
        _ => {
            let [x] = numbers(arguments)?;
            one(name, x)
        }
    }
}

#[allow(clippy::disallowed_methods, reason = "the document asks for acos and asin by name")]
fn one(name: &str, x: f64) -> Result<Value, Fault> {
    let value = match name {
        "acos" => x.acos(),
        "acosh" => x.acosh(),
        "asin" => x.asin(),
        "asinh" => x.asinh(),
        "atan" => x.atan(),
        "atanh" => x.atanh(),
        "cos" => x.cos(),
        "cosh" => x.cosh(),
        "degrees" => x * (180.0 / std::f64::consts::PI),
        "exp" => x.exp(),
        "expm1" => x.exp_m1(),
        "fabs" => x.abs(),
        "log" => x.ln(),
        "log10" => x.log10(),
        "log1p" => x.ln_1p(),
        "log2" => x.log2(),
        "radians" => x * (std::f64::consts::PI / 180.0),
        "sin" => x.sin(),
        "sinh" => x.sinh(),
        "sqrt" => x.sqrt(),
        "tan" => x.tan(),
        _ => x.tanh(),
    };
    if x.is_finite() && !value.is_finite() {
        return Err(domain(x));
    }
    if x.is_infinite() && value.is_nan() {
        return Err(domain(x));
    }
    Ok(Value::Float(value))
}

fn two(name: &str, a: f64, b: f64) -> Result<Value, Fault> {
    let value = match name {
        "atan2" => a.atan2(b),
        "copysign" => a.copysign(b),
        "fmod" => a % b,
        _ => a.powf(b),
    };
    if a.is_finite() && b.is_finite() && !value.is_finite() {
        return Err(Fault::value(format!("{a} and {b} are outside the domain of the function")));
    }
    Ok(Value::Float(value))
}

fn integers(name: &str, arguments: &[Value]) -> Result<Value, Fault> {
    let values = arguments
        .iter()
        .map(|value| value.as_integer().ok_or_else(|| Fault::value("an integer is expected")))
        .collect::<Result<Vec<_>, _>>()?;
    if name == "gcd" {
        let divisor = values.iter().fold(0u128, |mut a, b| {
            let mut b = b.unsigned_abs();
            while b != 0 {
                (a, b) = (b, a % b);
            }
            a
        });
        return i128::try_from(divisor).map(Value::Integer).map_err(|_| Fault::value("too large"));
    }
    match values[..] {
        // 33! is the largest that has 127 bits.
        [n @ 0..=33] => Ok(Value::Integer((1..=n).product())),
        _ => Err(Fault::value("an integer from 0 to 33 is expected")),
    }
}

fn domain(x: f64) -> Fault {
    Fault::value(format!("{x} is outside the domain of the function"))
}

/// An integral float as integer.
pub(super) fn rounded(value: f64) -> Result<Value, Fault> {
    // 2^127 as f64: below it the conversion is exact.
    const BOUND: f64 = 1.701_411_834_604_692_3e38;
    if !value.is_finite() || value.abs() >= BOUND {
        return Err(Fault::value(format!("{value} cannot be converted to an integer")));
    }
    #[allow(clippy::cast_possible_truncation, reason = "within ±2^127, as was just checked")]
    let integer = value as i128;
    Ok(Value::Integer(integer))
}

fn numbers<const N: usize>(arguments: &[Value]) -> Result<[f64; N], Fault> {
    let values: [&Value; N] = exactly_n(arguments)?;
    let mut numbers = [0.0; N];
    for (slot, value) in numbers.iter_mut().zip(values) {
        *slot = number(value)?;
    }
    Ok(numbers)
}

fn exactly(arguments: &[Value]) -> Result<[&Value; 1], Fault> {
    exactly_n(arguments)
}

fn exactly_n<const N: usize>(arguments: &[Value]) -> Result<[&Value; N], Fault> {
    let values: Vec<&Value> = arguments.iter().collect();
    values.try_into().map_err(|_| {
        Fault::value(format!("{N} argument{} expected, {} given", if N == 1 { "" } else { "s" }, arguments.len()))
    })
}

fn number(value: &Value) -> Result<f64, Fault> {
    value.as_float().ok_or_else(|| {
        let fault = Fault::value(format!("a number is expected, not {}", super::operators::describe(value)));
        match value {
            Value::Text(_) => fault.help("turn the text into a number with float(…)"),
            _ => fault,
        }
    })
}
