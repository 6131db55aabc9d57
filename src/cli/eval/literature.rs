//! A table of the literature's errors on Yosemite beside ours.

use clap::ValueEnum;

use crate::cli::print;
use crate::eval::data_set::Kind;
use crate::eval::{Class, FlowError, Row, Table};

/// A table in place of the general ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum NamedTable {
    /// Angular errors on Yosemite without its sky, beside those of the literature
    Yosemite,
}

impl NamedTable {
    /// The kind of data set that the table is of.
    pub(super) fn kind(self) -> Kind {
        match self {
            Self::Yosemite => Kind::Yosemite,
        }
    }

    /// The table for a terminal.
    pub(super) fn text(self, table: &Table) -> String {
        match self {
            Self::Yosemite => yosemite(table),
        }
    }
}

/// A published result: method, mean and standard deviation of the angular error in degrees, density in percent.
type Published = (&'static str, f64, Option<f64>, u32);

/// Published results on Yosemite without its sky, the best last. Farnebäck 2001 and the last one use more than two frames.
const PUBLISHED: &[Published] = &[
    ("Ju, Black, Jepson, CVPR 1996", 2.16, Some(2.00), 100),
    ("Farnebäck, SCIA 2003, affine, 3 iterations", 2.08, None, 100),
    ("Lai, Vemuri, IJCV 1998", 1.99, Some(1.41), 100),
    ("Brox et al., ECCV 2004, 2 frames", 1.59, Some(1.39), 100),
    ("Mémin, Pérez, ICCV 1998", 1.58, Some(1.21), 100),
    ("Farnebäck, ICCV 2001", 1.14, Some(2.14), 100),
    ("Brox et al., ECCV 2004, whole sequence", 0.98, Some(1.17), 100),
];

fn yosemite(table: &Table) -> String {
    let head = ["Yosemite without its sky", "pair", "AAE °", "± °", "density %"];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    for (method, aae_deg, std_deg, density) in PUBLISHED {
        let std = std_deg.map_or_else(|| "–".to_owned(), |std| format!("{std:.2}"));
        lines.push(vec![
            format!("{method} (quoted)"),
            "–".to_owned(),
            format!("{aae_deg:.2}"),
            std,
            density.to_string(),
        ]);
    }
    let mut ours: Vec<(&Row, FlowError)> =
        (table.pairs.iter()).filter_map(|row| Some((row, row.score.class(Class::All)?.error()))).collect();
    ours.sort_by(|(a, _), (b, _)| (&a.pair, &a.name).cmp(&(&b.pair, &b.name)));
    for (row, error) in ours {
        lines.push(vec![
            row.name.clone(),
            row.pair.clone().unwrap_or_default(),
            format!("{:.2}", error.aae_deg),
            format!("{:.2}", error.aae_std_deg),
            format!("{:.0}", 100.0 * error.density),
        ]);
    }
    format!(
        "{}Rows marked as quoted are published figures; {}.\n",
        print::table(&lines),
        match table.adapters.as_slice() {
            [] => "there are no others".to_owned(),
            adapters => format!("the others are measured on {}, from two frames", adapters.join(" and ")),
        }
    )
}
