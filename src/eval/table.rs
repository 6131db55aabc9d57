//! Results added up: for each pair, for each data set, and in total.

use std::collections::HashMap;

use super::{Class, Job, PairResult, PairTime, Score};

/// The results of some jobs, added up.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// What computed the flow.
    pub adapters: Vec<String>,
    /// The run with which others are compared; `None` without results.
    pub baseline: Option<String>,
    /// One row for each pair and run.
    pub pairs: Vec<Row>,
    /// One row for each data set and run, over the set's pairs.
    pub sets: Vec<Row>,
    /// One row for each run, over all pairs.
    pub total: Vec<Row>,
}

/// The figures of a run over some pairs.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The data set; `None` for all.
    pub set: Option<String>,
    /// The pair; `None` for all.
    pub pair: Option<String>,
    /// The run's name, with its backend if the table has several.
    pub name: String,
    /// The algorithm with its preset and parameters.
    pub run: String,
    /// `cpu` or `gpu`.
    pub backend: String,
    /// The pairs that the figures are over.
    pub scored: usize,
    /// The pairs that failed; no figure counts them.
    pub failed: usize,
    /// Why the row's pair failed; `None` if it did not, and for several pairs.
    pub reason: Option<String>,
    /// The errors over the pixels of all pairs.
    pub score: Score,
    /// The mean of the pairs' times; `None` if one was not measured.
    pub time: Option<PairTime>,
    /// The comparison with the baseline; `None` for figures that are undefined.
    pub ratios: Ratios,
}

/// The geometric means of the ratios of a run's figures to the baseline's on the same backend, over the pairs that both
/// have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Ratios {
    /// Of the mean endpoint error.
    pub aee: Option<f64>,
    /// Of the mean angular error.
    pub aae: Option<f64>,
    /// Of the wall time.
    pub time: Option<f64>,
}

impl Table {
    /// The table of results. Without a `baseline` the first run in their order is that.
    pub fn of(results: &[&PairResult], baseline: Option<&str>) -> Self {
        let mut sorted = results.to_vec();
        sorted.sort_by(|a, b| a.job.order(&b.job));
        let mut adapters: Vec<String> = sorted.iter().map(|result| result.adapter.clone()).collect();
        adapters.sort();
        adapters.dedup();
        let first = sorted.iter().map(|result| &result.job).min_by(|a, b| a.run_order(b));
        let baseline = baseline.or(first.map(|job| job.run.as_str())).filter(|_| !sorted.is_empty());
        let baseline = baseline.map(str::to_owned);
        let one_backend = sorted.iter().all(|result| result.job.backend == sorted[0].job.backend);
        let is_base = |result: &&&PairResult| Some(result.job.run.as_str()) == baseline.as_deref();
        let bases = sorted.iter().filter(is_base).filter(|result| result.score().is_some());
        let bases: Bases<'_> = bases.map(|result| (place(&result.job), *result)).collect();
        // A table can have many thousand results, but few runs.
        let mut runs: Vec<&Job> = sorted.iter().map(|result| &result.job).collect();
        runs.sort_by_key(|job| (&job.run, &job.backend));
        runs.dedup_by_key(|job| (&job.run, &job.backend));
        runs.sort_by(|a, b| a.run_order(b));
        let ranks: HashMap<(&str, &str), usize> = runs.iter().map(|job| run(job)).zip(0..).collect();
        let rows = |results: &[&PairResult], set: Option<&str>, pair: Option<&str>| {
            let mut by_run = results.to_vec();
            by_run.sort_by_key(|result| ranks.get(&run(&result.job)));
            let runs = by_run.chunk_by(|a, b| run(&a.job) == run(&b.job));
            runs.map(|own| {
                let Job { run, backend, .. } = &own[0].job;
                let name = if one_backend { run.clone() } else { format!("{run} on {backend}") };
                Row { name, ..Row::of(own, &bases, set, pair) }
            })
            .collect::<Vec<_>>()
        };
        let (mut pairs, mut sets) = (Vec::new(), Vec::new());
        for set in sorted.chunk_by(|a, b| a.job.set == b.job.set) {
            let name = Some(set[0].job.set.as_str());
            for pair in set.chunk_by(|a, b| a.job.pair == b.job.pair) {
                pairs.extend(rows(pair, name, Some(&pair[0].job.pair)));
            }
            sets.extend(rows(set, name, None));
        }
        let total = rows(&sorted, None, None);
        Self { adapters, baseline, pairs, sets, total }
    }
}

/// The scored results of the baseline, by data set, pair and backend.
type Bases<'a> = HashMap<[&'a str; 3], &'a PairResult>;

fn place(job: &Job) -> [&str; 3] {
    [&job.set, &job.pair, &job.backend]
}

fn run(job: &Job) -> (&str, &str) {
    (&job.run, &job.backend)
}

impl Row {
    /// The row of one run's results, of which there is at least one.
    fn of(own: &[&PairResult], bases: &Bases<'_>, set: Option<&str>, pair: Option<&str>) -> Self {
        let job = &own[0].job;
        let scored: Vec<(&PairResult, &Score)> =
            own.iter().filter_map(|result| Some((*result, result.score()?))).collect();
        let mut sum = Score::default();
        scored.iter().for_each(|(_, score)| sum.merge(score));
        let base = |of: &PairResult| bases.get(&place(&of.job)).copied();
        let couples: Vec<[&PairResult; 2]> =
            scored.iter().filter_map(|(result, _)| Some([*result, base(result)?])).collect();
        let mean = |figure: &dyn Fn(&PairResult) -> Option<f64>| geometric_mean(&couples, figure);
        let all_pixels = |result: &PairResult| result.score()?.class(Class::All).map(|tally| tally.error());
        Self {
            set: set.map(str::to_owned),
            pair: pair.map(str::to_owned),
            name: String::new(),
            run: job.run.clone(),
            backend: job.backend.clone(),
            scored: scored.len(),
            failed: own.len() - scored.len(),
            reason: own[0].failure().filter(|_| pair.is_some()).map(str::to_owned),
            time: mean_time(&scored.iter().map(|(result, _)| result.time()).collect::<Vec<_>>()),
            ratios: Ratios {
                aee: mean(&|result| Some(all_pixels(result)?.aee_px)),
                aae: mean(&|result| Some(all_pixels(result)?.aae_deg)),
                time: mean(&|result| Some(result.time()?.wall_ms)),
            },
            score: sum,
        }
    }
}

/// The geometric mean of ratios; `None` without any, and if one is not a finite number over 0.
fn geometric_mean(couples: &[[&PairResult; 2]], figure: &dyn Fn(&PairResult) -> Option<f64>) -> Option<f64> {
    let mut logarithms = 0.0;
    for [own, base] in couples {
        let ratio = figure(own)? / figure(base)?;
        logarithms += ratio.ln();
    }
    let mean = (logarithms / couples.len() as f64).exp();
    (mean.is_finite() && mean > 0.0).then_some(mean)
}

fn mean_time(times: &[Option<PairTime>]) -> Option<PairTime> {
    let times: Vec<PairTime> = times.iter().copied().collect::<Option<_>>()?;
    let mean = |sum: f64| sum / times.len() as f64;
    let processor_ms: Option<f64> = times.iter().map(|time| time.processor_ms).sum();
    let wall_ms = mean(times.iter().map(|time| time.wall_ms).sum());
    wall_ms.is_finite().then(|| PairTime { wall_ms, processor_ms: processor_ms.map(mean) })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::result::tests::{failed, result};
    use super::*;

    #[test]
    fn rows_add_up_by_hand() {
        let all = [
            result("a", "1", "farneback:default", 1.0),
            result("a", "2", "farneback:default", 4.0),
            result("a", "1", "farneback-tv:fast", 0.5),
            result("a", "2", "farneback-tv:fast", 0.5),
            result("b", "1", "farneback:default", 2.0),
            failed("b", "1", "farneback-tv:fast"),
        ];
        let table = Table::of(&all.iter().collect::<Vec<_>>(), None);
        assert_eq!(table.baseline.as_deref(), Some("farneback:default"));
        let reasons: Vec<_> = table.pairs.iter().filter_map(|row| row.reason.as_deref()).collect();
        assert_eq!(reasons, ["a.png: image is missing"]);
        assert!(table.sets.iter().chain(&table.total).all(|row| row.reason.is_none()));
        assert_eq!((table.pairs.len(), table.sets.len(), table.total.len()), (6, 4, 2));
        assert_eq!(table.sets[1].name, "farneback-tv:fast");
        let aee = |row: &Row| row.score.class(Class::All).map(|tally| tally.error().aee_px);
        let [base, tv, base_b, tv_b] = &table.sets[..] else { unreachable!() };
        assert_eq!((aee(base), aee(tv), aee(base_b), aee(tv_b)), (Some(2.5), Some(0.5), Some(2.0), None));
        // The square root of 1/2 × 1/8.
        assert!((tv.ratios.aee.unwrap() - 0.25).abs() < 1e-9 && base.ratios.aee == Some(1.0));
        assert_eq!((tv_b.scored, tv_b.failed, tv_b.ratios, tv_b.time), (0, 1, Ratios::default(), None));
        assert_eq!(table.total[0].time, Some(PairTime { wall_ms: 4.0, processor_ms: Some(8.0) }));
        assert_eq!((table.total[1].scored, table.total[1].failed), (2, 1));
        assert!((table.total[1].ratios.aee.unwrap() - 0.25).abs() < 1e-9);
    }

    #[test]
    fn a_baseline_without_error_or_results_gives_no_ratio() {
        let all = [result("a", "1", "farneback:default", 0.0), result("a", "1", "farneback-tv:fast", 0.5)];
        let refs: Vec<&PairResult> = all.iter().collect();
        assert_eq!(Table::of(&refs, None).sets[1].ratios.aee, None);
        assert_eq!(Table::of(&refs, Some("none")).sets[0].ratios, Ratios::default());
        let none = Table::of(&[], Some("farneback:default"));
        assert!(none.sets.is_empty() && none.baseline.is_none());
    }
}
