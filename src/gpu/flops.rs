//! The floating-point operations of a kernel, counted in its shader.

use std::collections::HashMap;

use naga::proc::TypeResolution;
use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{
    AddressSpace, BinaryOperator, Block, Expression, Function, Handle, Literal, LocalVariable, MathFunction,
    Module, ScalarKind, Statement, TypeInner,
};

use super::reflect::{DispatchShape, parse, reflect};
use crate::error::Result;
use crate::kernel::Kernel;
use crate::plan::Step;

/// A shader whose floating-point operations can be counted for given parameters.
///
/// Counted are additions, subtractions, multiplications, divisions and roots of `f32`, component by component, and exponential
/// and trigonometric functions as one each; a dot product of n components counts 2 n − 1. Comparisons, selections, minima,
/// roundings and conversions count nothing. Of two branches the longer one counts, and every loop runs to its bound. The
/// count is that of the text: a compiler may find common expressions.
pub struct FlopCounter {
    module: Module,
    info: ModuleInfo,
    shape: DispatchShape,
}

/// The values of a function's variables where they are known, by the last store.
type Variables = HashMap<Handle<LocalVariable>, i64>;

/// A function of the shader, with the bytes of the uniform struct.
#[derive(Clone, Copy)]
struct Scope<'a> {
    counter: &'a FlopCounter,
    function: &'a Function,
    info: &'a FunctionInfo,
    params: &'a [u8],
}

impl FlopCounter {
    /// Reads a kernel's shader.
    ///
    /// # Errors
    /// As [`reflect`].
    pub fn new(kernel: &Kernel) -> Result<Self> {
        let shape = reflect(kernel)?;
        let (module, info) = parse(kernel)?;
        Ok(Self { module, info, shape })
    }

    /// The operations of a step over all pixels of its image. `None` if a loop's bound depends on more than the parameters.
    pub fn of_step(&self, step: &Step) -> Option<u64> {
        let per_invocation = self.per_invocation(&step.params)? as f64;
        let DispatchShape { workgroup, tile, side_by_side, .. } = self.shape;
        let pixels = f64::from(step.extent.width * side_by_side) * f64::from(step.extent.height);
        let area = |sides: [u32; 2]| f64::from(sides[0]) * f64::from(sides[1]);
        Some((per_invocation * pixels * area(workgroup) / area(tile)).round() as u64)
    }

    /// The operations of one invocation, with these bytes of the uniform struct.
    pub fn per_invocation(&self, params: &[u8]) -> Option<u64> {
        let entry = self.module.entry_points.first()?;
        let info = self.info.get_entry_point(0);
        Scope { counter: self, function: &entry.function, info, params }
            .block(&entry.function.body, &mut Variables::new())
    }
}

impl Scope<'_> {
    fn block(self, block: &Block, variables: &mut Variables) -> Option<u64> {
        let mut sum = 0;
        for statement in block {
            sum += match statement {
                Statement::Emit(range) => range.clone().map(|handle| self.expression(handle)).sum(),
                Statement::Block(inner) => self.block(inner, variables)?,
                Statement::If { accept, reject, .. } => {
                    self.block(accept, variables)?.max(self.block(reject, variables)?)
                }
                Statement::Switch { cases, .. } => {
                    let mut most = 0;
                    for case in cases {
                        most = most.max(self.block(&case.body, variables)?);
                    }
                    most
                }
                Statement::Loop { body, continuing, .. } => {
                    let turns = self.turns(body, continuing, variables)?;
                    turns * (self.block(body, variables)? + self.block(continuing, variables)?)
                }
                Statement::Store { pointer, value } => {
                    if let Expression::LocalVariable(variable) = self.function.expressions[*pointer] {
                        match self.number(*value) {
                            Some(number) => variables.insert(variable, number),
                            None => variables.remove(&variable),
                        };
                    }
                    0
                }
                Statement::Call { function, .. } => {
                    let (callee, info) =
                        (&self.counter.module.functions[*function], &self.counter.info[*function]);
                    Scope { function: callee, info, ..self }.block(&callee.body, &mut Variables::new())?
                }
                _ => 0,
            };
        }
        Some(sum)
    }

    /// The number of turns of a loop that counts a variable up by one to a bound.
    fn turns(self, body: &Block, continuing: &Block, variables: &Variables) -> Option<u64> {
        let condition = body.iter().find_map(|statement| match statement {
            Statement::If { condition, reject, .. }
                if reject.iter().any(|s| matches!(s, Statement::Break)) =>
            {
                Some(*condition)
            }
            _ => None,
        })?;
        let Expression::Binary { op: BinaryOperator::Less, left, right } =
            self.function.expressions[condition]
        else {
            return None;
        };
        let variable = self.loaded(left)?;
        let counts_by_one = continuing.iter().any(|statement| {
            let Statement::Store { pointer, value } = statement else { return false };
            let Expression::Binary { op: BinaryOperator::Add, left, right } =
                self.function.expressions[*value]
            else {
                return false;
            };
            self.function.expressions[*pointer] == Expression::LocalVariable(variable)
                && self.loaded(left) == Some(variable)
                && self.number(right) == Some(1)
        });
        let first = variables.get(&variable).copied().or_else(|| {
            let init = self.function.local_variables[variable].init?;
            self.number(init)
        })?;
        let turns = self.number(right)? - first;
        counts_by_one.then(|| u64::try_from(turns).unwrap_or(0))
    }

    /// The variable that an expression loads.
    fn loaded(self, handle: Handle<Expression>) -> Option<Handle<LocalVariable>> {
        let Expression::Load { pointer } = self.function.expressions[handle] else { return None };
        match self.function.expressions[pointer] {
            Expression::LocalVariable(variable) => Some(variable),
            _ => None,
        }
    }

    /// The value of a whole number that constants and parameters determine.
    fn number(self, handle: Handle<Expression>) -> Option<i64> {
        let module = &self.counter.module;
        match &self.function.expressions[handle] {
            Expression::Literal(literal) => whole(*literal),
            Expression::Constant(constant) => {
                match &module.global_expressions[module.constants[*constant].init] {
                    Expression::Literal(literal) => whole(*literal),
                    _ => None,
                }
            }
            Expression::Load { pointer } => {
                let Expression::AccessIndex { base, index } = self.function.expressions[*pointer] else {
                    return None;
                };
                let Expression::GlobalVariable(variable) = self.function.expressions[base] else {
                    return None;
                };
                let variable = &module.global_variables[variable];
                let TypeInner::Struct { members, .. } = &module.types[variable.ty].inner else { return None };
                let member = members.get(index as usize)?;
                let is_whole = matches!(
                    module.types[member.ty].inner.scalar_kind(),
                    Some(ScalarKind::Uint | ScalarKind::Sint)
                );
                if variable.space != AddressSpace::Uniform || !is_whole {
                    return None;
                }
                let bytes = self.params.get(member.offset as usize..)?.first_chunk()?;
                Some(i64::from(u32::from_le_bytes(*bytes)))
            }
            Expression::Binary { op, left, right } => {
                let (left, right) = (self.number(*left)?, self.number(*right)?);
                match op {
                    BinaryOperator::Add => left.checked_add(right),
                    BinaryOperator::Subtract => left.checked_sub(right),
                    BinaryOperator::Multiply => left.checked_mul(right),
                    BinaryOperator::Divide => left.checked_div(right),
                    BinaryOperator::ShiftRight => left.checked_shr(u32::try_from(right).ok()?),
                    _ => None,
                }
            }
            Expression::Math { fun, arg, arg1: Some(arg1), .. } => {
                let (left, right) = (self.number(*arg)?, self.number(*arg1)?);
                match fun {
                    MathFunction::Min => Some(left.min(right)),
                    MathFunction::Max => Some(left.max(right)),
                    _ => None,
                }
            }
            // Of two numbers that a condition chooses the larger one.
            Expression::Select { accept, reject, .. } => {
                Some(self.number(*accept)?.max(self.number(*reject)?))
            }
            Expression::As { expr, kind: ScalarKind::Uint | ScalarKind::Sint, .. } => self.number(*expr),
            _ => None,
        }
    }

    /// The operations of one expression.
    fn expression(self, handle: Handle<Expression>) -> u64 {
        let size = |handle: Handle<Expression>| self.float_size(&self.info[handle].ty);
        match self.function.expressions[handle] {
            Expression::Binary {
                op:
                    BinaryOperator::Add
                    | BinaryOperator::Subtract
                    | BinaryOperator::Multiply
                    | BinaryOperator::Divide,
                ..
            } => size(handle),
            Expression::Math { fun, arg, .. } => match fun {
                MathFunction::Dot => (2 * size(arg)).saturating_sub(1),
                MathFunction::Cross => 9,
                MathFunction::Mix => 3 * size(handle),
                MathFunction::Fma | MathFunction::Length => 2 * size(arg),
                MathFunction::Distance | MathFunction::Normalize => 3 * size(arg),
                MathFunction::Sqrt
                | MathFunction::InverseSqrt
                | MathFunction::Exp
                | MathFunction::Exp2
                | MathFunction::Log
                | MathFunction::Log2
                | MathFunction::Pow
                | MathFunction::Sin
                | MathFunction::Cos
                | MathFunction::Tan
                | MathFunction::Asin
                | MathFunction::Acos
                | MathFunction::Atan
                | MathFunction::Atan2 => size(handle),
                _ => 0,
            },
            _ => 0,
        }
    }

    /// The number of a value's components if they are floating-point numbers, else 0.
    fn float_size(self, ty: &TypeResolution) -> u64 {
        match ty.inner_with(&self.counter.module.types) {
            TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Float => 1,
            TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Float => *size as u64,
            TypeInner::Matrix { columns, rows, .. } => *columns as u64 * *rows as u64,
            _ => 0,
        }
    }
}

fn whole(literal: Literal) -> Option<i64> {
    match literal {
        Literal::U32(value) => Some(i64::from(value)),
        Literal::I32(value) => Some(i64::from(value)),
        Literal::AbstractInt(value) => Some(value),
        _ => None,
    }
}
