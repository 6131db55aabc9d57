use std::fmt;
use std::str::FromStr;

use super::field::Field;
use super::{City, Corridor, Course, DeadEnd, Forest, Gates, PoissonForest, Wall, Wires};
use crate::error::{Error, Result};

/// A generator of courses with its parameters.
///
/// As text it is a name, followed by the parameters that differ from their defaults, each after a colon: `forest`,
/// `forest:density=1/64`, `wall:width=60:offset=-5..5`. A parameter drawn from a range is given by both ends or, if
/// these are equal, by one number; a number is a decimal or a quotient of two. Commas separate the elements of lists
/// of kinds.
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
    /// `wires`.
    Wires(Wires),
    /// `gates`.
    Gates(Gates),
}

impl CourseKind {
    /// All kinds with their defaults.
    pub fn all() -> [Self; 9] {
        [
            Self::Wall(Wall::default()),
            Self::Corridor(Corridor::default()),
            Self::City(City::default()),
            Self::Forest(Forest::default()),
            Self::Pillars(Forest::PILLARS),
            Self::PoissonForest(PoissonForest::default()),
            Self::DeadEnd(DeadEnd::default()),
            Self::Wires(Wires::default()),
            Self::Gates(Gates::default()),
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
            Self::Wires(_) => "wires",
            Self::Gates(_) => "gates",
        }
    }

    /// The course of a seed.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a parameter out of its range, and for more obstacles than a world can hold.
    pub fn course(&self, seed: u64) -> Result<Course> {
        let course = match self {
            Self::Wall(wall) => wall.course(seed),
            Self::Corridor(corridor) => corridor.course(seed),
            Self::City(city) => city.course(seed),
            Self::Forest(forest) | Self::Pillars(forest) => forest.course(seed),
            Self::PoissonForest(forest) => forest.course(seed),
            Self::DeadEnd(dead_end) => dead_end.course(seed),
            Self::Wires(wires) => wires.course(seed),
            Self::Gates(gates) => gates.course(seed),
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
            Self::Wires(wires) => wires.fields(),
            Self::Gates(gates) => gates.fields(),
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
        let mut given = Vec::new();
        for part in parts {
            let (key, value) = part.split_once('=').unwrap_or(("", part));
            let key = key.trim();
            if given.contains(&key) {
                let found = format_args!("{name} with {part:?} repeated");
                return Err(Error::parameter("world", found, "each parameter once"));
            }
            match fields.iter_mut().find(|field| field.name == key) {
                Some(field) => field.read(value.trim())?,
                None => {
                    let known: Vec<&str> = fields.iter().map(|field| field.name).collect();
                    let expected = format!("PARAMETER=VALUE with one of {}", known.join(", "));
                    return Err(Error::parameter("world", format_args!("{name} with {part:?}"), expected));
                }
            }
            given.push(key);
        }
        drop(fields);
        Ok(kind)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn defaults_are_named_by_their_name_alone() {
        for kind in CourseKind::all() {
            assert_eq!(kind.to_string(), kind.name());
            assert_eq!(kind.name().parse::<CourseKind>().unwrap(), kind);
            assert_eq!(kind.course(3).unwrap().name, kind.name());
        }
    }

    #[test]
    fn parameters_are_read_and_only_those_that_differ_are_shown() {
        let cases = [
            ("forest:density=1/64", "forest:density=0.015625"),
            ("forest:density=0.01", "forest"),
            (" forest : radius = 0.25 : density=4e-2", "forest:density=0.04:radius=0.25"),
            ("pillars:radius=.8..1", "pillars:radius=0.8..1"),
            ("wall:offset=-5..5:incidence=-20", "wall:incidence=-20:offset=-5..5"),
            ("poisson-forest:density=1/25:run-up=30", "poisson-forest:density=0.04:run-up=30"),
        ];
        for (text, shown) in cases {
            assert_eq!(text.parse::<CourseKind>().unwrap().to_string(), shown);
        }
        let kind =
            CourseKind::Wall(Wall { offset_m: [-5.0, 5.0], incidence_deg: [-20.0; 2], ..Wall::default() });
        assert_eq!(kind.to_string(), cases[4].1);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let cases = [
            (
                "woods",
                "world is \"woods\", expected wall, corridor, city, forest, pillars, poisson-forest, dead-end, wires",
            ),
            ("", "world is \"\", expected wall, corridor, "),
            (
                "forest:0.02",
                "world is forest with \"0.02\", expected PARAMETER=VALUE with one of density, radius, ",
            ),
            (
                "forest:width=3",
                "world is forest with \"width=3\", expected PARAMETER=VALUE with one of density, ",
            ),
            (
                "forest:radius",
                "world is forest with \"radius\", expected PARAMETER=VALUE with one of density, ",
            ),
            (
                "forest:radius=1:density=1/64: radius = 2",
                "world is forest with \"radius = 2\" repeated, expected each parameter once",
            ),
            ("forest:density=", "density is \"\", expected 0.0001 to 0.04 per m²"),
            ("forest:density=1", "density is \"1\", expected 0.0001 to 0.04 per m²"),
            ("forest:density=1/0", "density is \"1/0\", expected 0.0001 to 0.04 per m²"),
            ("forest:density=nan", "density is \"nan\", expected 0.0001 to 0.04 per m²"),
            ("forest:radius=0.4..0.2", "radius is \"0.4..0.2\", expected the lower end first: 0.2..0.4"),
            (
                "forest:radius=0.4..0.02",
                "radius is \"0.4..0.02\", expected a value or a range such as 0.05..5 within 0.05 to 5 m",
            ),
            ("forest:radius=0.2-0.4", "radius is \"0.2-0.4\", expected a value or a range such as 0.05..5"),
        ];
        for (text, expected) in cases {
            let found = text.parse::<CourseKind>().unwrap_err().to_string();
            assert!(found.starts_with(expected), "{found}");
        }
        let kind = CourseKind::City(City { length_m: f64::NAN, ..City::default() });
        assert_eq!(kind.course(0).unwrap_err().to_string(), "length is NaN, expected 10 to 2000 m");
    }

    #[test]
    fn a_world_of_too_many_trees_is_refused() {
        let kind: CourseKind = "forest:length=1000:density=1/25".parse().unwrap();
        let found = kind.course(0).map(|course| course.world.surfaces.len());
        assert!(found.as_ref().is_ok_and(|surfaces| (6000..8192).contains(surfaces)), "{found:?}");
        let kind: CourseKind = "poisson-forest:forest=1000:density=1/9".parse().unwrap();
        let found = kind.course(0).unwrap_err().to_string();
        assert_eq!(found, "world is 14129 obstacles by length and density, expected at most 8192");
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn what_is_shown_is_read_as_the_same(
            which in 0..8_usize,
            changes in prop::collection::vec((0..6_usize, -100.0..100.0_f64, 0.0..1.0_f64), 0..4),
        ) {
            let mut kind = CourseKind::all()[which];
            let mut fields = kind.fields();
            let count = fields.len();
            for (field, value, more) in changes {
                let value = if value > 0.0 { more / 7.0 } else { value };
                // A value out of range changes nothing.
                let field = &mut fields[field % count];
                let _ = field.read(&format!("{value}..{}", value + more)).or_else(|_| field.read(&value.to_string()));
            }
            drop(fields);
            prop_assert_eq!(kind.to_string().parse::<CourseKind>().unwrap(), kind);
        }

        #[test]
        fn text_that_looks_like_it_never_panics(
            text in "(wall|forest|city|corridor)(:(density|width|offset|radius)?=?[-0-9./e]{0,8}){0,4}",
        ) {
            let _ = text.parse::<CourseKind>();
        }
    }
}
