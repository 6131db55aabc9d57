//! Reflection: naga reads a kernel's shader and checks it against the kernel's Rust side. It needs no GPU.

use std::borrow::Cow;

use naga::back::pipeline_constants::process_overrides;
use naga::valid::ModuleInfo;
use naga::{AddressSpace, Expression, Function, GlobalVariable, Module, Statement, StorageAccess, TypeInner};

use crate::error::{Error, Result};
use crate::kernel::{Kernel, Variant};

/// The number of invocations per workgroup that every GPU allows.
const MAX_INVOCATIONS: u32 = 256;
/// The number of storage buffers per stage that every GPU allows.
pub(super) const MAX_STORAGE_BUFFERS: usize = 8;
/// The number of values in a table: a uniform input, `array<vec4f, 1024>`, a quarter of what every GPU allows.
pub(super) const TABLE: usize = 4096;

/// The properties of a shader that the host needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DispatchShape {
    /// Invocations per workgroup in x and y.
    pub workgroup: [u32; 2],
    /// Pixels per workgroup in x and y: the workgroup's size times the pixels per invocation, which are the shader's
    /// constant `SPAN`, or its `SPAN_X` and `SPAN_Y`, which may be `override` constants. A shader whose invocations share
    /// the work of a tile has the constant `TILE` in their place.
    pub tile: [u32; 2],
    /// Channels that lie side by side and are processed as one row: the shader's constant `SIDE_BY_SIDE`, or 1.
    pub side_by_side: u32,
    /// Which inputs are tables: bit i for input i.
    pub tables: u8,
}

impl DispatchShape {
    /// The number of workgroups for an image of this many columns and rows.
    pub fn workgroups(self, columns: u32, rows: u32) -> [u32; 3] {
        let count = |pixels: u32, axis: usize| pixels.div_ceil(self.tile[axis]);
        [count(columns * self.side_by_side, 0), count(rows, 1), 1]
    }
}

/// [`reflect_variant`] for the kernel's default variant, which keeps every value of the shader.
///
/// # Errors
/// As [`reflect_variant`].
pub fn reflect(kernel: &Kernel) -> Result<DispatchShape> {
    reflect_variant(kernel, &Variant::DEFAULT)
}

/// Parses and validates a kernel's shader, sets its `override` constants to the variant's values, and compares it with
/// the kernel's Rust side.
///
/// It compares the uniform struct (names, types, offsets, size), the bindings (names, order, kind, use), the workgroup
/// (at most 256 invocations) and the loops (each must have a bound that the shader states).
///
/// # Errors
/// [`Error::Kernel`], with every mismatch found. A constant of the variant that the shader does not declare is a
/// mismatch, too.
pub fn reflect_variant(kernel: &Kernel, variant: &Variant) -> Result<DispatchShape> {
    let fail = |problem: String| Error::Kernel { kernel: kernel.name.to_owned(), problem };
    let (module, info) = parse(kernel)?;
    let [entry] = module.entry_points.as_slice() else {
        return Err(fail(format!("{} entry points, expected 1", module.entry_points.len())));
    };
    let mut problems = Vec::new();
    if entry.name != "main" {
        problems.push(format!("entry point is {}, expected main", entry.name));
    }
    let usage = info.get_entry_point(0);
    let tables = check_bindings(kernel, &module, |handle| !usage[handle].is_empty(), &mut problems);

    // Everything that no override affects is read from the parsed module: the resolved one has lost what it never uses.
    let resolved = resolve(&module, &info, variant).map_err(fail)?;
    let entry = &resolved.entry_points[0];
    let [x, y, z] = entry.workgroup_size;
    if z != 1 || x.saturating_mul(y) > MAX_INVOCATIONS {
        problems.push(format!(
            "workgroup is {x}×{y}×{z}, expected at most {MAX_INVOCATIONS} invocations and z = 1"
        ));
    }
    check_loops(&resolved, &entry.function, "main", &mut problems);
    for (_, function) in resolved.functions.iter() {
        check_loops(&resolved, function, function.name.as_deref().unwrap_or("a function"), &mut problems);
    }
    let number = |name: &str| number(&module, name).or_else(|| number(&resolved, name));
    let pair = || Some([number("SPAN_X")?, number("SPAN_Y")?]);
    let span = constant_pair(&module, "SPAN").or_else(pair).map(|[span_x, span_y]| [x * span_x, y * span_y]);
    let tile = span.or_else(|| constant_pair(&module, "TILE")).filter(|tile| !tile.contains(&0));
    let tile = tile.unwrap_or_else(|| {
        problems.push(
            "constant SPAN is missing, expected a vec2u of pixels of an invocation, or SPAN_X and SPAN_Y, each a u32, \
             or TILE, a vec2u of pixels of a workgroup"
                .to_owned(),
        );
        [1, 1]
    });
    let side_by_side = number("SIDE_BY_SIDE").unwrap_or(1);
    if problems.is_empty() {
        Ok(DispatchShape { workgroup: [x, y], tile, side_by_side, tables })
    } else {
        Err(fail(problems.join("; ")))
    }
}

/// A kernel's shader, parsed and validated.
pub(super) fn parse(kernel: &Kernel) -> Result<(Module, ModuleInfo)> {
    let fail = |problem: String| Error::Kernel { kernel: kernel.name.to_owned(), problem };
    let module = naga::front::wgsl::parse_str(kernel.source)
        .map_err(|error| fail(error.emit_to_string_with_path(kernel.source, kernel.name)))?;
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    let info = validator.validate(&module).map_err(|error| fail(error.emit_to_string(kernel.source)))?;
    Ok((module, info))
}

/// The module with each `override` constant replaced by its value.
fn resolve<'a>(
    module: &'a Module,
    info: &'a ModuleInfo,
    variant: &Variant,
) -> Result<Cow<'a, Module>, String> {
    let declared: Vec<&str> = module.overrides.iter().filter_map(|(_, o)| o.name.as_deref()).collect();
    for (name, _) in variant.constants {
        if !declared.contains(name) {
            let declared = if declared.is_empty() { "none".to_owned() } else { declared.join(", ") };
            return Err(format!(
                "variant {} sets the constant {name}, expected an override of the shader: {declared}",
                variant.name
            ));
        }
    }
    let values = variant.constants.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let (resolved, _) = process_overrides(module, info, None, &values)
        .map_err(|error| format!("variant {}: {error}", variant.name))?;
    Ok(resolved)
}

/// Compares the bindings with the kernel, and returns which inputs are tables.
fn check_bindings(
    kernel: &Kernel,
    module: &Module,
    used: impl Fn(naga::Handle<GlobalVariable>) -> bool,
    problems: &mut Vec<String>,
) -> u8 {
    let mut tables = 0;
    let mut bound: Vec<_> = module.global_variables.iter().filter(|(_, var)| var.binding.is_some()).collect();
    bound.sort_by_key(|(_, var)| var.binding.map(|at| (at.group, at.binding)));
    let read = AddressSpace::Storage { access: StorageAccess::LOAD };
    let write = AddressSpace::Storage { access: StorageAccess::LOAD | StorageAccess::STORE };
    let expected: Vec<(&str, AddressSpace)> = std::iter::once(("params", AddressSpace::Uniform))
        .chain(kernel.inputs.iter().map(|name| (*name, read)))
        .chain(kernel.outputs.iter().map(|name| (*name, write)))
        .collect();
    if kernel.inputs.len() + kernel.outputs.len() > MAX_STORAGE_BUFFERS {
        problems.push(format!("more than {MAX_STORAGE_BUFFERS} storage buffers"));
    }
    if bound.len() != expected.len() {
        problems.push(format!("{} bindings, expected {}", bound.len(), expected.len()));
    }
    for (i, ((handle, var), (name, space))) in bound.into_iter().zip(expected).enumerate() {
        let found = var.name.as_deref().unwrap_or("without a name");
        let mut space = space;
        if (1..=kernel.inputs.len()).contains(&i) && is_table(module, var) {
            tables |= 1 << (i - 1);
            space = AddressSpace::Uniform;
        }
        let at = var.binding.map(|at| (at.group, at.binding));
        if found != name || var.space != space || at != Some((0, i as u32)) {
            problems.push(format!(
                "binding {at:?} is {found} ({:?}), expected {name} at {i} ({space:?})",
                var.space
            ));
        }
        if !used(handle) {
            problems.push(format!("{found} is never used, so the deduced layout would drop it"));
        }
        if i == 0 {
            check_params(kernel, module, var, problems);
        }
    }
    tables
}

/// Whether a binding is a table that all invocations read alike. Uniform buffers suit those on every GPU, and where
/// shaders run on the CPU they are three times as fast to read as storage.
fn is_table(module: &Module, var: &GlobalVariable) -> bool {
    var.space == AddressSpace::Uniform
        && matches!(module.types[var.ty].inner, TypeInner::Array { stride: 16, .. })
        && module.types[var.ty].inner.size(module.to_ctx()) as usize == size_of::<[f32; TABLE]>()
}

fn check_params(kernel: &Kernel, module: &Module, var: &GlobalVariable, problems: &mut Vec<String>) {
    let TypeInner::Struct { members, span } = &module.types[var.ty].inner else {
        problems.push("params is not a struct".to_owned());
        return;
    };
    if *span as usize != kernel.params.size {
        problems.push(format!("params has {span} bytes in WGSL and {} in Rust", kernel.params.size));
    }
    let wgsl: Vec<_> = members
        .iter()
        .map(|m| {
            (m.name.clone().unwrap_or_default(), m.offset as usize, type_name(&module.types[m.ty].inner))
        })
        .collect();
    let rust: Vec<_> =
        kernel.params.fields.iter().map(|f| (f.name.to_owned(), f.offset, f.ty.to_owned())).collect();
    if wgsl != rust {
        problems.push(format!("params is {wgsl:?} in WGSL and {rust:?} in Rust"));
    }
}

fn type_name(inner: &TypeInner) -> String {
    let scalar = |scalar: naga::Scalar| match scalar.kind {
        naga::ScalarKind::Float => format!("f{}", 8 * scalar.width),
        naga::ScalarKind::Uint => format!("u{}", 8 * scalar.width),
        naga::ScalarKind::Sint => format!("i{}", 8 * scalar.width),
        kind => format!("{kind:?}"),
    };
    match inner {
        TypeInner::Scalar(s) => scalar(*s),
        TypeInner::Vector { size, scalar: s } => format!("vec{}<{}>", *size as u8, scalar(*s)),
        other => format!("{other:?}"),
    }
}

/// Checks that every loop begins with a comparison whose bound the shader states: a constant, or `min(…, CONSTANT)`.
fn check_loops(module: &Module, function: &Function, name: &str, problems: &mut Vec<String>) {
    let mut blocks = vec![&function.body];
    while let Some(block) = blocks.pop() {
        for statement in block.iter() {
            match statement {
                Statement::Loop { body, continuing, .. } => {
                    if !body.iter().any(|s| leaves_at_bound(module, function, s)) {
                        problems.push(format!("a loop in {name} has no stated bound: compare with a constant or min(…, CONSTANT)"));
                    }
                    blocks.extend([body, continuing]);
                }
                Statement::If { accept, reject, .. } => blocks.extend([accept, reject]),
                Statement::Block(inner) => blocks.push(inner),
                Statement::Switch { cases, .. } => blocks.extend(cases.iter().map(|case| &case.body)),
                _ => {}
            }
        }
    }
}

fn leaves_at_bound(module: &Module, function: &Function, statement: &Statement) -> bool {
    let Statement::If { condition, reject, .. } = statement else { return false };
    let leaves = reject.iter().any(|s| matches!(s, Statement::Break));
    let Expression::Binary { op: naga::BinaryOperator::Less, right, .. } = function.expressions[*condition]
    else {
        return false;
    };
    let constant = |e: naga::Handle<Expression>| match function.expressions[e] {
        Expression::Literal(_) => true,
        Expression::Constant(c) => {
            matches!(module.global_expressions[module.constants[c].init], Expression::Literal(_))
        }
        _ => false,
    };
    let bounded = match function.expressions[right] {
        Expression::Math { fun: naga::MathFunction::Min, arg, arg1: Some(arg1), .. } => {
            constant(arg) || constant(arg1)
        }
        _ => constant(right),
    };
    leaves && bounded
}

/// The value of a constant that is one `u32`.
fn number(module: &Module, name: &str) -> Option<u32> {
    let (_, constant) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name))?;
    match module.global_expressions[constant.init] {
        Expression::Literal(naga::Literal::U32(value)) => Some(value),
        _ => None,
    }
}

/// The value of a constant that is one `vec2u`.
fn constant_pair(module: &Module, name: &str) -> Option<[u32; 2]> {
    let (_, constant) = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name))?;
    let Expression::Compose { components, .. } = &module.global_expressions[constant.init] else {
        return None;
    };
    let value = |i: usize| match module.global_expressions[*components.get(i)?] {
        Expression::Literal(naga::Literal::U32(value)) => Some(value),
        _ => None,
    };
    Some([value(0)?, value(1)?])
}
