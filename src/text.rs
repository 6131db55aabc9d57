//! Words that several modules write.

/// A count and its noun: `1 flight`, `2 flights`.
pub(crate) fn counted(count: usize, one: &str) -> String {
    format!("{count} {one}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_singular() {
        assert_eq!([0, 1, 2].map(|count| counted(count, "flight")), ["0 flights", "1 flight", "2 flights"]);
    }
}
