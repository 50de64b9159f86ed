//! Wrong pixels where the rows of the right view are off.

use hsad::{Backend, seeding::Rectification};

use crate::{
    AnyError, Named,
    markdown::{columns, heading, mean, percent, row},
    matched::matched,
    scores,
    variant::Variant,
};

pub fn print(backend: &Backend, scenes: &[Named]) -> Result<(), AnyError> {
    let variants = Variant::of_rows();
    let names: Vec<String> = variants.iter().map(|variant| variant.name()).collect();
    let names: Vec<&str> = ["scene"].into_iter().chain(names.iter().map(String::as_str)).collect();
    let (mut bad, mut models) = (Vec::new(), Vec::new());
    for Named { name, scene } in scenes {
        let (mut shares, mut found) = (Vec::new(), vec![name.clone()]);
        for variant in &variants {
            eprintln!("{name}: {}", variant.name());
            let (changed, config) = variant.of(scene, &scene.right)?;
            let outcome = matched(backend, &changed, &config)?.outcome;
            let share = scores::bad_one(&changed, &outcome.dense)?;
            // Without a mask, all pixels with known truth.
            shares.push(if share.non_occluded.is_nan() { share.all } else { share.non_occluded });
            found.push(model(&outcome.seeding.rectification));
        }
        bad.push((name, shares));
        models.push(found);
    }
    heading("Rows: wrong by over 1 px, % of the non-occluded pixels");
    columns(&names);
    let cells = |name: &str, shares: &mut dyn Iterator<Item = f64>| {
        row(&[name.to_owned()].into_iter().chain(shares.map(percent)).collect::<Vec<_>>());
    };
    bad.iter().for_each(|(name, shares)| cells(name, &mut shares.iter().copied()));
    cells("mean", &mut (0..variants.len()).map(|i| mean(bad.iter().map(|(_, shares)| shares[i]))));
    heading("Rows found: verdict, offset at the centre in px, rotation in degrees, scale");
    columns(&names);
    models.iter().for_each(|cells| row(cells));
    Ok(())
}

/// The verdict and the model of the rows in short.
fn model(found: &Rectification) -> String {
    let Rectification { verdict, offset, rotation, scale, .. } = found;
    if found.is_rectified() {
        verdict.to_string()
    } else {
        format!("{verdict}, {offset:.2}, {rotation:.2}, {scale:.3}")
    }
}
