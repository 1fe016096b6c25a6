//! Functions over sequences: `min`, `sorted`, `map`, `range` and similar.

use std::rc::Rc;

use super::Fault;
use super::builtins::{count_of, no_names};
use super::evaluate::{Arguments, Evaluator};
use super::operators::{binary, describe, equal, order};
use super::syntax::Binary;
use super::value::{Dict, Value};

pub(super) fn fold(name: &str, mut arguments: Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    let key = take_named(&mut arguments, "key");
    let default = take_named(&mut arguments, "default");
    no_names(&arguments)?;
    let extremum = matches!(name, "min" | "max");
    let items = match &arguments.plain[..] {
        [] => return Err(Fault::value("1 argument expected, 0 given")),
        [only] => evaluator.items(only)?,
        [sequence, _] if name == "sum" => evaluator.items(sequence)?,
        several if extremum => several.to_vec(),
        several => return Err(Fault::value(format!("1 argument expected, {} given", several.len()))),
    };
    match name {
        "all" => Ok(Value::Bool(items.iter().all(Value::is_true))),
        "any" => Ok(Value::Bool(items.iter().any(Value::is_true))),
        "sum" => {
            let mut sum = arguments.plain.get(1).cloned().unwrap_or(Value::Integer(0));
            for item in &items {
                sum = binary(Binary::Add, &sum, item, evaluator.meter())?;
            }
            Ok(sum)
        }
        _ => {
            let keys = keys(&items, key.as_ref(), evaluator)?;
            let mut best: Option<usize> = None;
            for at in 0..items.len() {
                let better = match best {
                    None => true,
                    Some(best) => {
                        let ordering = ordered(&keys[at], &keys[best], evaluator)?;
                        if name == "min" { ordering.is_lt() } else { ordering.is_gt() }
                    }
                };
                if better {
                    best = Some(at);
                }
            }
            best.map(|at| items[at].clone())
                .or(default)
                .ok_or_else(|| Fault::value("there are no items to choose from"))
        }
    }
}

fn take_named(arguments: &mut Arguments, name: &str) -> Option<Value> {
    let at = arguments.named.iter().position(|(named, _)| &**named == name)?;
    Some(arguments.named.remove(at).1)
}

fn keys(items: &[Value], key: Option<&Value>, evaluator: &mut Evaluator<'_>) -> Result<Vec<Value>, Fault> {
    match key {
        None | Some(Value::None) => Ok(items.to_vec()),
        Some(key) => items
            .iter()
            .map(|item| evaluator.call(key, Arguments { plain: vec![item.clone()], named: Vec::new() }))
            .collect(),
    }
}

fn ordered(a: &Value, b: &Value, evaluator: &mut Evaluator<'_>) -> Result<std::cmp::Ordering, Fault> {
    let numbers = a.as_float().is_some() && b.as_float().is_some();
    match order(a, b, evaluator.meter())? {
        Some(ordering) => Ok(ordering),
        // NaN, which Python leaves where it is.
        None if numbers => Ok(std::cmp::Ordering::Equal),
        None => Err(Fault::value(format!("{} and {} cannot be ordered", describe(a), describe(b)))),
    }
}

pub(super) fn sequence(name: &str, mut arguments: Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    match name {
        "dict" => return dictionary(&arguments, evaluator),
        "range" => return range(&arguments, evaluator),
        "sorted" => {
            let key = take_named(&mut arguments, "key");
            let reverse = take_named(&mut arguments, "reverse").is_some_and(|value| value.is_true());
            count_of(&arguments, 1..=1)?;
            let items = evaluator.items(&arguments.plain[0])?;
            return sorted(items, key.as_ref(), reverse, evaluator);
        }
        "enumerate" => {
            let start = take_named(&mut arguments, "start").or_else(|| arguments.plain.get(1).cloned());
            let start = start.and_then(|start| start.as_integer()).unwrap_or(0);
            let Some(values) = arguments.plain.first() else {
                return Err(Fault::value("1 argument expected, 0 given"));
            };
            let items = evaluator.items(values)?;
            let numbered = items
                .into_iter()
                .zip(0i128..)
                .map(|(item, at)| Value::tuple(vec![Value::Integer(start.saturating_add(at)), item]));
            return Ok(Value::list(numbered.collect()));
        }
        _ => {}
    }
    no_names(&arguments)?;
    match name {
        "list" | "tuple" | "reversed" => {
            count_of(&arguments, usize::from(name == "reversed")..=1)?;
            let mut items = match arguments.plain.first() {
                Some(value) => evaluator.items(value)?,
                None => Vec::new(),
            };
            if name == "reversed" {
                items.reverse();
            }
            Ok(if name == "tuple" { Value::tuple(items) } else { Value::list(items) })
        }
        "map" | "filter" => {
            let Some((function, sequences)) = arguments.plain.split_first() else {
                return Err(Fault::value("2 arguments expected, 0 given"));
            };
            let rows = rows(sequences, evaluator)?;
            let mut items = Vec::new();
            for row in rows {
                let kept = row.first().cloned().unwrap_or(Value::None);
                let result = match function {
                    Value::None => kept.clone(),
                    _ => evaluator.call(function, Arguments { plain: row, named: Vec::new() })?,
                };
                if name == "map" {
                    items.push(result);
                } else if result.is_true() {
                    items.push(kept);
                }
            }
            Ok(Value::list(items))
        }
        _ => Ok(Value::list(rows(&arguments.plain, evaluator)?.into_iter().map(Value::tuple).collect())),
    }
}

/// First items, second items, … up to the shortest sequence.
fn rows(sequences: &[Value], evaluator: &mut Evaluator<'_>) -> Result<Vec<Vec<Value>>, Fault> {
    let columns = sequences.iter().map(|values| evaluator.items(values)).collect::<Result<Vec<_>, _>>()?;
    let shortest = columns.iter().map(Vec::len).min().unwrap_or(0);
    Ok((0..shortest).map(|at| columns.iter().map(|column| column[at].clone()).collect()).collect())
}

fn sorted(
    items: Vec<Value>,
    key: Option<&Value>,
    reverse: bool,
    evaluator: &mut Evaluator<'_>,
) -> Result<Value, Fault> {
    let keys = keys(&items, key, evaluator)?;
    let mut keyed: Vec<(Value, Value)> = keys.into_iter().zip(items).collect();
    if reverse {
        keyed.reverse();
    }
    let keyed = merge_sorted(keyed, evaluator)?;
    let mut items: Vec<Value> = keyed.into_iter().map(|(_, item)| item).collect();
    if reverse {
        items.reverse();
    }
    Ok(Value::list(items))
}

/// A stable sort by the first of each pair. Values may have no order among them, where the standard library's sort could
/// panic.
fn merge_sorted(mut pairs: Vec<(Value, Value)>, evaluator: &mut Evaluator<'_>) -> Result<Vec<(Value, Value)>, Fault> {
    if pairs.len() < 2 {
        return Ok(pairs);
    }
    let upper = pairs.split_off(pairs.len() / 2);
    let mut merged = Vec::with_capacity(pairs.len() + upper.len());
    let mut left = merge_sorted(pairs, evaluator)?.into_iter().peekable();
    let mut right = merge_sorted(upper, evaluator)?.into_iter().peekable();
    while let (Some(a), Some(b)) = (left.peek(), right.peek()) {
        let from_right = ordered(&b.0, &a.0, evaluator)?.is_lt();
        merged.extend(if from_right { right.next() } else { left.next() });
    }
    merged.extend(left.chain(right));
    Ok(merged)
}

fn dictionary(arguments: &Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    let mut dict = Dict::default();
    match &arguments.plain[..] {
        [] => {}
        [Value::Dict(other)] => {
            evaluator.meter().step(other.entries().len())?;
            for (key, value) in other.entries() {
                dict.insert(key.clone(), value.clone())?;
            }
        }
        [pairs] => {
            for pair in evaluator.items(pairs)? {
                let [key, value]: [Value; 2] = evaluator
                    .items(&pair)?
                    .try_into()
                    .map_err(|_| Fault::value("pairs of key and value are expected"))?;
                dict.insert(key, value)?;
            }
        }
        _ => return Err(Fault::value("1 argument expected")),
    }
    for (name, value) in &arguments.named {
        dict.insert(Value::Text(Rc::clone(name)), value.clone())?;
    }
    Ok(Value::Dict(Rc::new(dict)))
}

fn range(arguments: &Arguments, evaluator: &mut Evaluator<'_>) -> Result<Value, Fault> {
    count_of(arguments, 1..=3)?;
    let bounds = arguments
        .plain
        .iter()
        .map(|value| {
            value.as_integer().ok_or_else(|| Fault::value(format!("an integer is expected, not {}", describe(value))))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let (start, stop, step) = match bounds[..] {
        [stop] => (0, stop, 1),
        [start, stop] => (start, stop, 1),
        _ => (bounds[0], bounds[1], bounds[2]),
    };
    if step == 0 {
        return Err(Fault::value("the step is 0"));
    }
    let span = if step > 0 { stop.saturating_sub(start) } else { start.saturating_sub(stop) };
    let width = step.unsigned_abs();
    let count = u128::try_from(span).unwrap_or(0).div_ceil(width);
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    evaluator.meter().step(count.saturating_mul(2))?;
    let mut values = Vec::with_capacity(count);
    let mut at = start;
    for _ in 0..count {
        values.push(Value::Integer(at));
        at = at.saturating_add(step);
    }
    Ok(Value::list(values))
}

/// Whether a value is among others.
pub(super) fn position(items: &[Value], wanted: &Value, evaluator: &mut Evaluator<'_>) -> Result<Option<usize>, Fault> {
    for (at, item) in items.iter().enumerate() {
        if equal(item, wanted, evaluator.meter())? {
            return Ok(Some(at));
        }
    }
    Ok(None)
}
