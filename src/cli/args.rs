//! The command line's grammar; its doc comments are the program's help.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::geometry::Vec3;
use crate::shade;

/// Which ray tracing structure, which grid resolution and which intersection method for this mesh on this machine: what
/// does it cost, and where does it break?
///
/// Without a command, raylab opens the terminal lab on the given scenes (default: the bundled ones).
#[derive(Debug, Parser)]
#[command(name = "raylab", version, args_conflicts_with_subcommands = true, after_help = EXIT_CODES)]
pub struct Cli {
    /// Scenes to open: a bundled name, a procedural family with its size (`sphereflake:3`), or a path to an .obj
    pub scenes: Vec<String>,
    /// What to do instead of opening the lab
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXIT_CODES: &str = "Exit codes: 0 ok, 1 failure, 2 usage, 3 regression, 4 correctness mismatch, 5 bad input, \
                          130 interrupted.";

/// Everything that works without a terminal.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Print a registry: its entries, what they are for, and their parameters
    List(ListArgs),
    /// Render a scene to a PNG, or as blocks in the terminal
    Render(RenderArgs),
    /// Measure every combination of scenes, accelerators, resolutions, kernels, ray sets and thread counts
    Sweep(SweepArgs),
    /// Show every step of one ray: cells or nodes, tests, hit
    Inspect(InspectArgs),
    /// Count what each kernel decides wrongly, by exact arithmetic, beside its speed
    Accuracy(AccuracyArgs),
    /// Try every kernel and accelerator where methods are known to break, and compare with what is known
    Stability(StabilityArgs),
    /// Write a ray set to a file
    Rays(RaysArgs),
    /// Trace the rays of a file and write their hits
    Trace(TraceArgs),
    /// Write plots and tables from a report
    Report(ReportArgs),
    /// Print a completion script for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page, in roff
    Man,
}

/// A registry.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Registry {
    /// Bundled scenes and procedural families
    Scenes,
    /// Spatial structures
    Accels,
    /// Ray/triangle intersection methods
    Kernels,
    /// Ray sets
    Rays,
    /// Cases of the stability suite
    Cases,
    /// Export formats of reports
    Formats,
    /// What a rendered picture can show
    Channels,
}

/// Arguments of `list`.
#[derive(Debug, Args)]
pub struct ListArgs {
    /// Which registry
    pub registry: Registry,
    /// Print an array of objects
    #[arg(long)]
    pub json: bool,
}

/// What one configuration is.
#[derive(Debug, Args)]
pub struct ConfigArgs {
    /// Accelerator, with parameters as `grid:overlap=sat:mailbox=off` [default: the fastest own one]
    #[arg(long, value_name = "ACCEL")]
    pub accel: Option<String>,
    /// Grid resolution: a number, or `auto` for the predictor's choice
    #[arg(long, value_name = "N", default_value = "auto")]
    pub n: String,
    /// Intersection kernel, with parameters as `sheet-unsigned:eps=1e-4`
    #[arg(long, value_name = "KERNEL", default_value = "woop")]
    pub kernel: String,
    /// Threads: a number, or `max`
    #[arg(long, value_name = "COUNT", default_value = "max")]
    pub threads: String,
    /// Seed of everything random
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Print nothing but the result
    #[arg(long)]
    pub quiet: bool,
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The scene
    pub scene: String,
    /// Write a PNG here instead of printing blocks
    #[arg(long, value_name = "FILE.png")]
    pub out: Option<PathBuf>,
    /// What a pixel shows; see `raylab list channels`
    #[arg(long, default_value = "color")]
    pub channel: String,
    /// Pixels of the PNG, or columns and rows of the terminal [default: 960x720, or the terminal]
    #[arg(long, value_name = "WxH", value_parser = shade::parse_size)]
    pub size: Option<(u32, u32)>,
    /// How terminal cells are drawn: half, solid, quadrant, sextant, octant or ascii [default: half, ascii without colour]
    #[arg(long, value_name = "SYMBOLS", num_args = 0..=1, default_missing_value = "sextant")]
    pub symbols: Option<String>,
    /// Colours of the terminal: auto, true, 256, 16 or none
    #[arg(long, default_value = "auto", value_name = "COLORS")]
    pub color: String,
    /// Another view
    #[command(flatten)]
    pub camera: CameraArgs,
    /// The configuration that renders
    #[command(flatten)]
    pub config: ConfigArgs,
}

/// What is changed of the scene's camera.
#[derive(Debug, Args)]
pub struct CameraArgs {
    /// Where the camera stands
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vec3, allow_hyphen_values = true)]
    pub eye: Option<Vec3>,
    /// What the camera looks at
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vec3, allow_hyphen_values = true)]
    pub at: Option<Vec3>,
    /// Vertical field of view
    #[arg(long, value_name = "DEGREES", value_parser = parse_fov)]
    pub fov: Option<f32>,
}

/// Arguments of `inspect`.
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// The scene
    pub scene: String,
    /// The ray through the centre of this pixel; 0,0 is the upper left one
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel, required_unless_present_any = ["origin", "rays_file"])]
    pub pixel: Option<(u32, u32)>,
    /// Pixels of the picture that `--pixel` is in [default: 960x720]
    #[arg(long, value_name = "WxH", value_parser = shade::parse_size)]
    pub size: Option<(u32, u32)>,
    /// The ray from this point along `--dir`, instead of a pixel's
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vec3, allow_hyphen_values = true, requires = "dir", conflicts_with_all = ["pixel", "size", "eye", "at", "fov"])]
    pub origin: Option<Vec3>,
    /// Direction of the ray from `--origin`, and the unit of t
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vec3, allow_hyphen_values = true, requires = "origin")]
    pub dir: Option<Vec3>,
    /// A ray of this .rays file, with its interval of t, instead of a pixel's
    #[arg(long, value_name = "FILE.rays", conflicts_with_all = ["pixel", "size", "eye", "at", "fov", "origin", "dir"])]
    pub rays_file: Option<PathBuf>,
    /// Which ray of the file, counted from 0
    #[arg(
        long,
        value_name = "INDEX",
        default_value_t = 0,
        requires = "rays_file"
    )]
    pub ray: usize,
    /// Another view
    #[command(flatten)]
    pub camera: CameraArgs,
    /// The configuration that is followed
    #[command(flatten)]
    pub config: ConfigArgs,
}

/// Arguments of `sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// Scenes, separated by commas [default: teapot]
    #[arg(long, value_name = "SCENES")]
    pub scene: Vec<String>,
    /// Accelerators, separated by commas [default: all but those measured only on request]
    #[arg(long, value_name = "ACCELS")]
    pub accel: Vec<String>,
    /// Grid resolutions: `1..256` (about two an octave), `8..64:8` (steps of 8), `8,16,auto`
    #[arg(long, value_name = "RANGE")]
    pub n: Option<String>,
    /// Kernels, separated by commas [default: woop]
    #[arg(long, value_name = "KERNELS")]
    pub kernel: Vec<String>,
    /// Ray sets, separated by commas [default: primary]
    #[arg(long, value_name = "SETS")]
    pub rays: Vec<String>,
    /// Thread counts, separated by commas; `max` is all cores [default: max]
    #[arg(long, value_name = "COUNTS")]
    pub threads: Option<String>,
    /// Another axis: values of a parameter of the accelerators or kernels, e.g. `mailbox=on,off`
    #[arg(long, value_name = "KEY=V1,V2")]
    pub set: Vec<String>,
    /// Rays of a set
    #[arg(long, value_name = "COUNT")]
    pub rays_count: Option<usize>,
    /// Fewer rays and samples: an overview in a minute or two
    #[arg(long)]
    pub quick: bool,
    /// Write the report bundle into this directory
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with the interrupted sweep in this bundle; its own plan counts
    #[arg(long, value_name = "DIR", conflicts_with_all = ["scene", "accel", "n", "kernel", "rays", "threads", "set", "out", "quick"])]
    pub resume: Option<PathBuf>,
    /// Print the report to standard output
    #[arg(long)]
    pub json: bool,
    /// Seed of everything random
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Print nothing but the result
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `accuracy`.
#[derive(Debug, Args)]
pub struct AccuracyArgs {
    /// The scenes
    #[arg(required_unless_present = "resume", value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Kernels, separated by commas [default: all]
    #[arg(long, value_name = "KERNELS")]
    pub kernel: Vec<String>,
    /// Accelerators, separated by commas [default: the fastest own one]
    #[arg(long, value_name = "ACCELS")]
    pub accel: Vec<String>,
    /// Grid resolutions, for accelerators that have one
    #[arg(long, value_name = "RANGE", default_value = "auto")]
    pub n: String,
    /// Ray sets, separated by commas [default: edge,random]
    #[arg(long, value_name = "SETS")]
    pub rays: Vec<String>,
    /// How far scene and rays are moved from their place along each axis, separated by commas
    #[arg(long, value_name = "OFFSETS", default_value = "0,1e4")]
    pub offset: String,
    /// Factors by which scene and rays are scaled about the origin before that, separated by commas
    #[arg(long, value_name = "SCALES", default_value = "1")]
    pub scale: String,
    /// Another axis: values of a parameter of the kernels or accelerators, e.g. `eps=1e-7,1e-5,1e-3`
    #[arg(long, value_name = "KEY=V1,V2")]
    pub set: Vec<String>,
    /// Rays of a set
    #[arg(long, value_name = "COUNT")]
    pub rays_count: Option<usize>,
    /// Threads: a number, or `max`
    #[arg(long, value_name = "COUNT", default_value = "max")]
    pub threads: String,
    /// Fewer rays and samples: a first look
    #[arg(long)]
    pub quick: bool,
    /// Write the report bundle into this directory
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with the interrupted measurement in this bundle; its own plan counts
    #[arg(long, value_name = "DIR", conflicts_with_all = ["scenes", "accel", "n", "kernel", "rays", "offset", "scale", "set", "rays_count", "threads", "seed", "out", "quick"])]
    pub resume: Option<PathBuf>,
    /// Print the report to standard output
    #[arg(long)]
    pub json: bool,
    /// Seed of everything random
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Print nothing but the result
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `stability`.
#[derive(Debug, Args)]
pub struct StabilityArgs {
    /// Cases, separated by commas; see `raylab list cases` [default: all]
    #[arg(long, value_name = "CASES")]
    pub case: Vec<String>,
    /// Kernels, separated by commas [default: all]
    #[arg(long, value_name = "KERNELS")]
    pub kernel: Vec<String>,
    /// Accelerators, separated by commas; brute force, which judges them, is always there [default: all]
    #[arg(long, value_name = "ACCELS")]
    pub accel: Vec<String>,
    /// Try accelerators with `woop` and `exact` only
    #[arg(long)]
    pub quick: bool,
    /// Write the map as JSON, SVG and PNG into this directory, and for each failing cell the least scene and ray
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the map with every cell as JSON
    #[arg(long)]
    pub json: bool,
    /// Threads: a number, or `max`
    #[arg(long, value_name = "COUNT", default_value = "max")]
    pub threads: String,
    /// Seed of all cases; the bounds of known failures are those of seed 1
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Print nothing but the result
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `rays`.
#[derive(Debug, Args)]
pub struct RaysArgs {
    /// The scene
    pub scene: String,
    /// The ray set; see `raylab list rays`
    #[arg(long, value_name = "SET")]
    pub rays: String,
    /// The file to write: eight little-endian f32 a ray (ox oy oz `t_min` dx dy dz `t_max`)
    #[arg(long, value_name = "FILE.rays")]
    pub out: PathBuf,
    /// Rays of the set
    #[arg(long, value_name = "COUNT", default_value_t = 65_536)]
    pub rays_count: usize,
    /// Seed of everything random
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
    /// Print nothing
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `trace`.
#[derive(Debug, Args)]
pub struct TraceArgs {
    /// The scene
    pub scene: String,
    /// The rays: eight little-endian f32 a ray (ox oy oz `t_min` dx dy dz `t_max`)
    #[arg(long, value_name = "FILE.rays")]
    pub rays_file: PathBuf,
    /// The file to write: a u32 triangle (0xFFFFFFFF is a miss) and an f32 t a ray
    #[arg(long, value_name = "FILE.hits")]
    pub hits: Option<PathBuf>,
    /// Ask only whether each ray is blocked: u32 0 or 1 and f32 0 a ray
    #[arg(long)]
    pub occluded: bool,
    /// The configuration that traces
    #[command(flatten)]
    pub config: ConfigArgs,
}

/// Arguments of `report`.
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// A report.json
    pub report: PathBuf,
    /// Formats, separated by commas; see `raylab list formats`
    #[arg(long, value_name = "FORMATS", default_value = "html,svg,png")]
    pub format: String,
    /// Directory to write into
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Reads `x,y,z`, all finite.
fn parse_vec3(text: &str) -> Result<Vec3, String> {
    let parts: Vec<f32> = text
        .split(',')
        .map(|p| p.trim().parse().ok().filter(|x: &f32| x.is_finite()))
        .collect::<Option<_>>()
        .ok_or("write three finite numbers, e.g. 1,2.5,-3")?;
    <[f32; 3]>::try_from(parts)
        .map(Vec3::from_array)
        .map_err(|p| format!("{} numbers where three are needed", p.len()))
}

/// Reads `x,y`, both from 0.
fn parse_pixel(text: &str) -> Result<(u32, u32), String> {
    text.split_once(',')
        .and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)))
        .ok_or_else(|| "write a column and a row counted from 0, e.g. 320,240".to_owned())
}

/// Reads degrees between 0.1 and 179.
fn parse_fov(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|x| (0.1..=179.0).contains(x))
        .ok_or_else(|| "write degrees from 0.1 to 179".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_grammar_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_scene_without_a_command_opens_the_lab() {
        let cli = Cli::try_parse_from(["raylab", "teapot", "soup:100,0.5"]).unwrap();
        assert_eq!(cli.scenes, ["teapot", "soup:100,0.5"]);
        assert!(cli.command.is_none());
    }

    #[test]
    fn vectors_and_angles_are_checked() {
        assert_eq!(parse_vec3("1,-2, 3.5"), Ok(Vec3::new(1.0, -2.0, 3.5)));
        for bad in ["1,2", "1,2,nan", "1,2,3,4", ""] {
            assert!(parse_vec3(bad).is_err(), "{bad}");
        }
        assert!(parse_fov("0").is_err() && parse_fov("45").is_ok());
        assert_eq!(parse_pixel("3, 40"), Ok((3, 40)));
        for bad in ["3", "3,-1", "3,4,5", "a,b", ""] {
            assert!(parse_pixel(bad).is_err(), "{bad}");
        }
    }
}
