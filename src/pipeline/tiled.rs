//! The map of a pair whose tiles are matched elsewhere: cut here, and put together here.

use super::{Clock, Given, Known, Outcome, search::Found, seeded, views::Views};
use crate::{
    backend::Backend,
    config::{Config, Method},
    dense::DenseConfig,
    error::{Error, Result},
    gpu::block_on,
    io::Picture,
    tiles::{TileMap, TilePair, Tiling, merged},
};

/// Cuts the tiles of a pair whose rows correspond, or are slightly off: [`Config::tiles`] says how. The range is searched as it was found;
/// [`super::run`] searches a wider one where the map touches an end.
///
/// # Errors
/// See [`super::run`]; [`Error::Parameter`] without [`Config::tiles`], and for Kamencay's method.
pub fn cut_tiles(backend: &Backend, views: (&Picture, &Picture), config: &Config) -> Result<Vec<TilePair>> {
    block_on(async {
        let pictures = [views.0, views.1];
        let (views, known) = prepared(backend, pictures, config).await?;
        let (tiling, task) = task(&views, &known, config)?;
        let whole = views.whole(pictures, &task);
        Ok(tiling.tiles(views.size(), &task).into_iter().map(|tile| whole.cut(tile)).collect())
    })
}

/// The outcome of a pair from the maps of its tiles, as [`super::run`] finds it with the range of the tiles in [`Config::range`].
///
/// # Errors
/// As [`cut_tiles`]; [`Error::Parameter`] for tiles that are not those of the pair, each once, or were matched over another range or with other
/// parameters.
pub fn merge_tiles(
    backend: &Backend,
    views: (&Picture, &Picture),
    config: &Config,
    maps: &[TileMap],
) -> Result<Outcome> {
    block_on(async {
        let pictures = [views.0, views.1];
        let (views, known) = prepared(backend, pictures, config).await?;
        let (tiling, task) = task(&views, &known, config)?;
        let dense = merged(views.size(), &tiling.tiles(views.size(), &task), &task, maps)?;
        let found = Found::new(&views, task.range, dense, config.reference);
        Ok(known.outcome(views, &Given { pictures, rectified: None }, config, found))
    })
}

async fn prepared<'a>(backend: &'a Backend, pictures: [&'a Picture; 2], config: &Config) -> Result<(Views<'a>, Known)> {
    let given = Given { pictures, rectified: None };
    let seeded = seeded(backend, &given, config, |_| false, &mut Clock::new(|_| ())).await?;
    let (views, known) = seeded.expect("rows that nobody says to be unfit");
    Ok((views.drowned().await?, known))
}

fn task(views: &Views<'_>, known: &Known, config: &Config) -> Result<(Tiling, DenseConfig)> {
    let (Some(tiling), Method::Hsad(parameters)) = (config.tiles, &config.method) else {
        let expected = "`tiles` and `method` hsad are needed".into();
        return Err(Error::Parameter { name: "tiles", value: "not given".into(), expected });
    };
    let task = config.dense(parameters, known.range, known.brightness);
    let range = task.searched(views.size().width)?;
    Ok((tiling, DenseConfig { range, ..task }))
}
