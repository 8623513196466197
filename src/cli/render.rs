//! `raylab render`: a picture as a PNG, or as blocks on standard output.

use std::io::IsTerminal;

use serde_json::json;

use crate::preview::{self, Cells, ColorMode, Symbols};
use crate::scene::{Camera, Scene};
use crate::shade::{self, Channel, Rendered, View};

use super::args::RenderArgs;
use super::session::{Built, Config, PNG_SIZE, load};
use super::table::significant;
use super::{Failure, print};

/// Columns and rows when no size is given and standard output is no terminal.
const CELLS: (u16, u16) = (80, 24);

/// Where the picture goes.
enum Target {
    /// A file, and its size in pixels.
    Png((u32, u32)),
    /// Standard output, in columns and rows.
    Blocks {
        columns: u16,
        rows: u16,
        symbols: &'static Symbols,
        mode: ColorMode,
    },
}

/// Renders, writes or prints the picture, and says what it took on standard error.
pub fn run(args: &RenderArgs) -> Result<(), Failure> {
    let channel = shade::channel(&args.channel)?;
    let target = target(args)?;
    let config = Config::read(&args.config)?;
    let scene = load(&args.scene, args.config.quiet)?;
    let pool = config.pool()?;
    let built = pool.install(|| config.build(&scene))?;
    let camera = args.camera.of(&scene);
    let rendered = pool.install(|| picture(&scene, &camera, &built, channel, &target));

    match &target {
        Target::Png(_) => {
            if let Some(path) = &args.out {
                preview::write_png(&rendered.image, path)?;
            }
        }
        Target::Blocks {
            columns,
            rows,
            symbols,
            mode,
        } => {
            let cells = Cells::of(&rendered.image, *columns, *rows, symbols, *mode);
            if !args.config.json {
                print(&preview::to_ansi(&cells))?;
                if let Some(legend) = &rendered.legend {
                    print(&preview::to_ansi(&preview::legend_bar(
                        legend, *columns, *mode,
                    )))?;
                }
            }
        }
    }
    tell(args, &config, &built, &rendered)
}

/// What was rendered, how, and what the scene was found to need.
fn tell(
    args: &RenderArgs,
    config: &Config,
    built: &Built,
    rendered: &Rendered,
) -> Result<(), Failure> {
    if args.config.json {
        let result = json!({
            "scene": args.scene,
            "channel": args.channel,
            "out": args.out,
            "size": [rendered.image.width, rendered.image.height],
            "accel": config.accel_label(),
            "n": built.n,
            "kernel": config.kernel.name,
            "threads": config.threads,
            "build_ms": built.build_ms,
            "found": rendered.stats.found,
            "rays": {
                "primary": rendered.stats.rays.primary,
                "hits": rendered.stats.rays.hits,
                "shadow": rendered.stats.rays.shadow,
            },
        });
        return print(&format!("{result:#}\n"));
    }
    if !args.config.quiet {
        let n = built.n.map_or(String::new(), |n| format!(" n={n}"));
        eprintln!(
            "{}: {}; {}{n}, {}, built in {} ms",
            args.scene,
            rendered.stats.found,
            config.accel_label(),
            config.kernel.name,
            significant(built.build_ms),
        );
        if let Some(path) = &args.out {
            eprintln!("wrote {}", path.display());
        }
    }
    Ok(())
}

/// Where the picture goes and how large it is.
fn target(args: &RenderArgs) -> Result<Target, Failure> {
    // Checked even for a PNG, so that a misspelt word is never ignored.
    let asked = ColorMode::parse(&args.color)?;
    let symbols = preview::symbols(args.symbols.as_deref().unwrap_or("half"))?;
    if args.out.is_some() {
        return Ok(Target::Png(args.size.unwrap_or(PNG_SIZE)));
    }
    let (columns, rows) = match args.size {
        Some((columns, rows)) => (columns as u16, rows as u16),
        None => terminal_cells(),
    };
    let mode = ColorMode::detect(asked, std::io::stdout().is_terminal(), |name| {
        std::env::var(name).ok()
    });
    Ok(Target::Blocks {
        columns,
        rows,
        symbols,
        mode,
    })
}

/// The terminal's columns and rows, less two rows for the legend and the prompt.
fn terminal_cells() -> (u16, u16) {
    match crossterm::terminal::size() {
        Ok((columns, rows)) if std::io::stdout().is_terminal() && columns > 0 => {
            (columns, rows.saturating_sub(2).max(1))
        }
        _ => CELLS,
    }
}

fn picture(
    scene: &Scene,
    camera: &Camera,
    built: &Built,
    channel: &Channel,
    target: &Target,
) -> Rendered {
    let (width, height) = match target {
        Target::Png(size) => *size,
        Target::Blocks {
            columns,
            rows,
            symbols,
            ..
        } => preview::pixel_size(*columns, *rows, symbols),
    };
    shade::render(&View {
        scene,
        camera,
        accel: built.accel.as_ref(),
        channel,
        width,
        height,
    })
}
