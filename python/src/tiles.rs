//! Large pictures in tiles, as rows of tables: cut, matched by whoever has a row, put together.

use std::{path::Path, time::Instant};

use hsad::{
    Config, Dense, DisparityRange, Error, Luma, Size,
    config::Method,
    dense::{Aggregation, Brightness, DenseConfig, Search},
    disparity::fixed_point,
    gpu::block_on,
    io::{Picture, load, pfm, png},
    pipeline,
    tiles::{Area, Tile, TileMap, TilePair},
};
use pyo3::{
    import_exception,
    prelude::*,
    pybacked::PyBackedBytes,
    types::{PyBytes, PyDict, PyList},
};

use crate::{
    backend::backend,
    encoded::{Encoded, decoded, of_tiles},
    errors::Raise,
    options::given,
};

import_exception!(hsad._errors, ParameterError);

const VIEW: [&str; 4] = ["view_x", "view_y", "view_width", "view_height"];
const CORE: [&str; 4] = ["x", "y", "width", "height"];
const MASKS: [&str; 2] = ["own_mask", "other_mask"];

/// Cuts a large pair into tiles, each with all that its disparities depend on.
///
/// Rows must correspond, or be slightly off; they are aligned, and range and brightness found, from the whole pair. A tile is matched by
/// :func:`match_tile`, wherever, with the same bytes; :func:`merge_tiles` puts the maps together, or they are left as they are.
///
/// Parameters
/// ----------
/// left, right : bytes
///     The files of the views, as for :func:`match_encoded`.
/// device : str
///     As for :func:`match`.
/// **options
///     As for :func:`match`; ``tiles``, the side of a tile in pixels, is needed.
///
/// Returns
/// -------
/// list of dict
///     A row per tile: ``tile``, its number from 0; ``x``, ``y``, ``width`` and ``height``, its place in the picture, in pixels;
///     ``view_x``, ``view_y``, ``view_width`` and ``view_height``, the part of both views that it is matched from; the views and their
///     masks as PNG; ``min_disparity``, ``disparities``, ``gain``, ``offset`` and ``levels``, found from the whole pair; ``options``, a
///     text.
///
/// Raises
/// ------
/// ParameterError, FormatError, NotRectifiedError, NoRangeError, DeviceError
///     As for :func:`match_encoded`; NotRectifiedError for pairs that :func:`rectify` must rectify first.
#[pyfunction]
#[pyo3(signature = (left, right, *, device = "best", **options))]
pub fn cut_tiles<'py>(
    py: Python<'py>,
    left: &[u8],
    right: &[u8],
    device: &str,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyList>> {
    let config = given(options)?.config().raise()?;
    let backend = backend(py, device)?;
    let pairs = py.detach(|| {
        let pair = decoded([Some(left), Some(right)], NAMES.map(Path::new))?;
        pipeline::cut_tiles(&backend, (&pair.left, &pair.right), &config)
    });
    let text = py.import("json")?.call_method1("dumps", (options,))?;
    let rows = (0..).zip(pairs.raise()?).map(|(number, pair): (u32, TilePair)| row(py, number, &pair, &text));
    PyList::new(py, rows.collect::<PyResult<Vec<_>>>()?)
}

/// Matches a tile.
///
/// Parameters
/// ----------
/// tile : dict
///     A row of :func:`cut_tiles`.
/// device : str
///     As for :func:`match`.
///
/// Returns
/// -------
/// tuple of bytes
///     Disparities of the tile's pixels as a PFM, in pixels, +inf for none, and confidences as a PNG.
///
/// Raises
/// ------
/// ParameterError, FormatError
///     A row that :func:`cut_tiles` has not made.
/// DeviceError
///     As for :func:`match`.
#[pyfunction]
#[pyo3(signature = (tile, *, device = "best"))]
pub fn match_tile<'py>(
    py: Python<'py>,
    tile: &Bound<'py, PyDict>,
    device: &str,
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyBytes>)> {
    let pair = pair_of(tile)?;
    let backend = backend(py, device)?;
    let [map, confidence] = py
        .detach(|| {
            let Dense { disparity, confidence } = block_on(pair.dense(&backend))?;
            Ok([file(|out| pfm::write_disparities(out, &disparity)), file(|out| png::write_grey8(out, &confidence))])
        })
        .raise()?;
    Ok((PyBytes::new(py, &map), PyBytes::new(py, &confidence)))
}

/// Puts the maps of all tiles of a pair together.
///
/// Parameters
/// ----------
/// left, right : bytes
///     The files of the views that were cut.
/// tiles : list of dict
///     The rows of :func:`cut_tiles`, of which all but the views and their masks are needed, with the answers of :func:`match_tile` as
///     ``disparity`` and ``confidence``; in any order.
/// names : tuple of str
///     What the report calls the views.
/// device : str
///     As for :func:`match`.
///
/// Returns
/// -------
/// Encoded
///     What :func:`match_encoded` finds with the same options and the range of the tiles.
///
/// Raises
/// ------
/// ParameterError, FormatError
///     Tiles of another pair, of different ranges or options, missing ones and those that are there twice; damaged maps.
#[pyfunction]
#[pyo3(signature = (left, right, tiles, *, names = ("left".into(), "right".into()), device = "best"))]
pub fn merge_tiles(
    py: Python<'_>,
    left: &[u8],
    right: &[u8],
    tiles: Vec<Bound<'_, PyDict>>,
    names: (String, String),
    device: &str,
) -> PyResult<Encoded> {
    let Some(first) = tiles.first() else { return Err(ParameterError::new_err("there is no tile to put together")) };
    let range = range_of(first)?;
    let config = Config { range: Some(range), least: Some(range.min), ..config_of(first)? };
    let map = |row| Ok(TileMap { tile: place_of(row)?, config: dense_config_of(row)?, dense: map_of(row)? });
    let maps = tiles.iter().map(map).collect::<PyResult<Vec<_>>>()?;
    let backend = backend(py, device)?;
    let (names, start) = ([names.0, names.1], Instant::now());
    py.detach(|| {
        let pair = decoded([Some(left), Some(right)], names.each_ref().map(Path::new))?;
        let outcome = pipeline::merge_tiles(&backend, (&pair.left, &pair.right), &config, &maps)?;
        Ok(of_tiles(&backend, &pair, &names, &config, (outcome, start)))
    })
    .raise()
}

const NAMES: [&str; 2] = ["left", "right"];

fn row<'py>(
    py: Python<'py>,
    number: u32,
    pair: &TilePair,
    options: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let row = PyDict::new(py);
    row.set_item("tile", number)?;
    for (names, Area { x, y, size }) in [(CORE, pair.tile.core), (VIEW, pair.tile.view)] {
        names
            .into_iter()
            .zip([x, y, size.width, size.height])
            .try_for_each(|(name, value)| row.set_item(name, value))?;
    }
    let bytes = |data: Vec<u8>| PyBytes::new(py, &data);
    let grey = |plane: &Luma| bytes(file(|out| png::write_grey8(out, plane)));
    for (name, view) in NAMES.iter().zip(&pair.luma) {
        row.set_item(name, grey(view))?;
    }
    // A picture of which nothing was seen is none for decoders.
    let colours = pair.colours.as_ref().filter(|picture| picture.data().iter().any(|&[.., alpha]| alpha > 0));
    row.set_item("colors", colours.map(|picture| bytes(file(|out| png::write_rgba8(out, picture)))))?;
    for (name, mask) in MASKS.iter().zip(&pair.masks) {
        row.set_item(name, mask.as_ref().map(grey))?;
    }
    row.set_item("keeps_hidden", pair.keeps_hidden)?;
    let DenseConfig { range, brightness, parameters, .. } = &pair.config;
    let levels = match &parameters.aggregation {
        Aggregation::Costs(costs) => match costs.search {
            Search::Levels(levels) => levels,
            _ => 1,
        },
        Aggregation::Sad { .. } => 1,
    };
    row.set_item("min_disparity", range.min)?;
    row.set_item("disparities", range.count)?;
    row.set_item("gain", brightness.gain)?;
    row.set_item("offset", brightness.offset)?;
    row.set_item("levels", levels)?;
    row.set_item("options", options)?;
    Ok(row)
}

fn file(write: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()>) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&mut bytes).expect("memory takes whatever is written");
    bytes
}

fn value<'py, T>(row: &Bound<'py, PyDict>, name: &str) -> PyResult<T>
where
    T: for<'a> FromPyObject<'a, 'py>,
{
    let lacking = || ParameterError::new_err(format!("the tile has no {name}: a row of hsad.cut_tiles is needed"));
    let value = row.get_item(name)?.ok_or_else(lacking)?;
    value
        .extract()
        .map_err(|_| ParameterError::new_err(format!("{name} of the tile is {value}, which is of another kind")))
}

fn area_of(row: &Bound<'_, PyDict>, names: [&str; 4]) -> PyResult<Area> {
    let [x, y, width, height] = names.map(|name| value::<u32>(row, name));
    Ok(Area { x: x?, y: y?, size: Size::new(width?, height?) })
}

fn place_of(row: &Bound<'_, PyDict>) -> PyResult<Tile> {
    let tile = Tile { core: area_of(row, CORE)?, view: area_of(row, VIEW)? };
    let is_within = |start: [u32; 2], length: [u32; 2]| {
        let end = u64::from(start[0]) + u64::from(length[0]);
        start[0] >= start[1] && end <= u64::from(start[1]) + u64::from(length[1]) && length[0] > 0
    };
    let Tile { core, view } = tile;
    if is_within([core.x, view.x], [core.size.width, view.size.width])
        && is_within([core.y, view.y], [core.size.height, view.size.height])
    {
        return Ok(tile);
    }
    Err(ParameterError::new_err(format!("the tile is no part of its view: {tile:?}")))
}

fn range_of(row: &Bound<'_, PyDict>) -> PyResult<DisparityRange> {
    DisparityRange::new(value(row, "min_disparity")?, value(row, "disparities")?).raise()
}

fn config_of(row: &Bound<'_, PyDict>) -> PyResult<Config> {
    let options = row.py().import("json")?.call_method1("loads", (value::<String>(row, "options")?,))?;
    given(options.cast().ok())?.config().raise()
}

fn dense_config_of(row: &Bound<'_, PyDict>) -> PyResult<DenseConfig> {
    let config = config_of(row)?;
    let Method::Hsad(mut parameters) = config.method else {
        return Err(ParameterError::new_err("method is kamencay, which is not for tiles"));
    };
    let levels: u32 = value(row, "levels")?;
    if let Aggregation::Costs(costs) = &mut parameters.aggregation {
        costs.search = if levels > 1 { Search::Levels(levels.min(24)) } else { Search::Whole };
    }
    let brightness = Brightness { gain: value(row, "gain")?, offset: value(row, "offset")? };
    Ok(DenseConfig { range: range_of(row)?, reference: config.reference, brightness, parameters })
}

fn pair_of(row: &Bound<'_, PyDict>) -> PyResult<TilePair> {
    let tile = place_of(row)?;
    let picture = |name: &str| -> PyResult<Option<Picture>> {
        let Some(bytes) = value::<Option<PyBackedBytes>>(row, name)? else { return Ok(None) };
        let picture = load::decode(&bytes, Path::new(name)).raise()?;
        if picture.size() == tile.view.size {
            return Ok(Some(picture));
        }
        Err(ParameterError::new_err(format!(
            "{name} of the tile is {} pixels, but its view is {}",
            picture.size(),
            tile.view.size
        )))
    };
    let plane = |name| PyResult::Ok(picture(name)?.map(|picture| picture.map(|&[grey, ..]| grey)));
    let view = |name| plane(name)?.ok_or_else(|| ParameterError::new_err(format!("the tile has no {name} view")));
    let [own, other] = MASKS.map(plane);
    Ok(TilePair {
        tile,
        luma: [view("left")?, view("right")?],
        colours: picture("colors")?,
        masks: [own?, other?],
        keeps_hidden: value(row, "keeps_hidden")?,
        config: dense_config_of(row)?,
    })
}

fn map_of(row: &Bound<'_, PyDict>) -> PyResult<Dense> {
    let [map, confidence] = ["disparity", "confidence"].map(|name| value::<PyBackedBytes>(row, name));
    let disparity = pfm::decode(&map?, Path::new("disparity")).raise()?.map(|&pixels| fixed_point(pixels));
    let confidence = load::decode(&confidence?, Path::new("confidence")).raise()?.map(|&[grey, ..]| grey);
    if confidence.size() != disparity.size() {
        let reason = format!("{} confidences of {} disparities", confidence.size(), disparity.size());
        return Err(Error::Format { path: "confidence".into(), reason }).raise();
    }
    Ok(Dense { disparity, confidence })
}
