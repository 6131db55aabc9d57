use std::fmt;
use std::str::FromStr;

use super::field::Field;
use super::{City, Corridor, Course, DeadEnd, Forest, PoissonForest, Wall};
use crate::error::{Error, Result};

/// A generator of courses with its parameters.
///
/// As text it is a name, and after colons the parameters that are not at their defaults: `forest`,
/// `forest:density=1/64`, `wall:width=60:offset=-5..5`. A parameter that is drawn from a range is given by both ends or, if
/// these are the same, by one number; a number is a decimal or a quotient of two. Commas are left to lists of these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CourseKind {
    /// `wall`.
    Wall(Wall),
    /// `corridor`.
    Corridor(Corridor),
    /// `city`.
    City(City),
    /// `forest`.
    Forest(Forest),
    /// `pillars`: [`Forest::PILLARS`].
    Pillars(Forest),
    /// `poisson-forest`.
    PoissonForest(PoissonForest),
    /// `dead-end`.
    DeadEnd(DeadEnd),
}

impl CourseKind {
    /// All kinds with their defaults.
    pub fn all() -> [Self; 7] {
        [
            Self::Wall(Wall::default()),
            Self::Corridor(Corridor::default()),
            Self::City(City::default()),
            Self::Forest(Forest::default()),
            Self::Pillars(Forest::PILLARS),
            Self::PoissonForest(PoissonForest::default()),
            Self::DeadEnd(DeadEnd::default()),
        ]
    }

    /// The name, without parameters.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Wall(_) => "wall",
            Self::Corridor(_) => "corridor",
            Self::City(_) => "city",
            Self::Forest(_) => "forest",
            Self::Pillars(_) => "pillars",
            Self::PoissonForest(_) => "poisson-forest",
            Self::DeadEnd(_) => "dead-end",
        }
    }

    /// The course of a seed.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter out of its range, and for more obstacles than a world holds.
    pub fn course(&self, seed: u64) -> Result<Course> {
        let course = match self {
            Self::Wall(wall) => wall.course(seed),
            Self::Corridor(corridor) => corridor.course(seed),
            Self::City(city) => city.course(seed),
            Self::Forest(forest) | Self::Pillars(forest) => forest.course(seed),
            Self::PoissonForest(forest) => forest.course(seed),
            Self::DeadEnd(dead_end) => dead_end.course(seed),
        }?;
        Ok(Course { name: self.to_string(), ..course })
    }

    fn fields(&mut self) -> Vec<Field<'_>> {
        match self {
            Self::Wall(wall) => wall.fields(),
            Self::Corridor(corridor) => corridor.fields(),
            Self::City(city) => city.fields(),
            Self::Forest(forest) | Self::Pillars(forest) => forest.fields(),
            Self::PoissonForest(forest) => forest.fields(),
            Self::DeadEnd(dead_end) => dead_end.fields(),
        }
    }

    fn of_name(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|kind| kind.name() == name)
    }
}

impl fmt::Display for CourseKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, mut kind) = (self.name(), *self);
        f.write_str(name)?;
        let mut default = Self::of_name(name);
        let defaults = default.as_mut().map(Self::fields).unwrap_or_default();
        for (field, default) in kind.fields().iter().zip(&defaults) {
            if !field.is_as(default) {
                write!(f, ":{}={field}", field.name)?;
            }
        }
        Ok(())
    }
}

impl FromStr for CourseKind {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut parts = text.split(':').map(str::trim);
        let name = parts.next().unwrap_or_default();
        let mut kind = Self::of_name(name).ok_or_else(|| {
            Error::parameter(
                "world",
                format_args!("{name:?}"),
                Self::all().map(|kind| kind.name()).join(", "),
            )
        })?;
        let mut fields = kind.fields();
        for part in parts {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            match fields.iter_mut().find(|field| field.name == key.trim()) {
                Some(field) => field.read(value.trim())?,
                None => {
                    let known: Vec<&str> = fields.iter().map(|field| field.name).collect();
                    let expected = format!("PARAMETER=VALUE with one of {}", known.join(", "));
                    return Err(Error::parameter("world", format_args!("{name} with {part:?}"), expected));
                }
            }
        }
        drop(fields);
        Ok(kind)
    }
}
