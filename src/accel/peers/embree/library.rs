//! What raylab declares of Embree's interface, and the library that has it, looked for once at run time.
//!
//! Versions 3 and 4 differ in how a query is called; the ray structures are the same up to fields at their end, for which
//! there is room. Nothing is taken from the library's headers: these few declarations are all that is needed.

use std::ffi::{c_char, c_int, c_void};
use std::sync::OnceLock;

use libloading::Library;

/// A device, scene or geometry of the library.
pub(super) type Handle = *mut c_void;

/// `RTC_INVALID_GEOMETRY_ID`: no hit.
pub(super) const INVALID: u32 = u32::MAX;
/// `RTC_GEOMETRY_TYPE_TRIANGLE`.
pub(super) const TRIANGLES: c_int = 0;
/// `RTC_BUFFER_TYPE_INDEX` and `RTC_FORMAT_UINT3`.
pub(super) const INDICES: (c_int, c_int) = (0, 0x5003);
/// `RTC_BUFFER_TYPE_VERTEX` and `RTC_FORMAT_FLOAT3`.
pub(super) const VERTICES: (c_int, c_int) = (1, 0x9003);
/// `RTC_BUILD_QUALITY_MEDIUM`.
pub(super) const MEDIUM: c_int = 1;
/// `RTC_BUILD_QUALITY_HIGH`.
pub(super) const HIGH: c_int = 2;
/// `RTC_SCENE_FLAG_ROBUST`.
pub(super) const ROBUST: c_int = 1 << 2;

/// Rays of a packet.
pub(super) const WIDTH: usize = 16;

/// `RTCRayHit` with room for what later versions append. A ray is its first 48 bytes.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(16))]
pub(super) struct RayHit {
    pub origin: [f32; 3],
    pub t_near: f32,
    pub dir: [f32; 3],
    pub time: f32,
    pub t_far: f32,
    pub mask: u32,
    pub id: u32,
    pub flags: u32,
    pub normal: [f32; 3],
    pub u: f32,
    pub v: f32,
    pub prim: u32,
    pub geometry: u32,
    pub instance: [u32; 5],
}

/// `RTCRayHit16` with room for what later versions append.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Packet {
    pub origin: [[f32; WIDTH]; 3],
    pub t_near: [f32; WIDTH],
    pub dir: [[f32; WIDTH]; 3],
    pub time: [f32; WIDTH],
    pub t_far: [f32; WIDTH],
    pub mask: [u32; WIDTH],
    pub id: [u32; WIDTH],
    pub flags: [u32; WIDTH],
    pub normal: [[f32; WIDTH]; 3],
    pub u: [f32; WIDTH],
    pub v: [f32; WIDTH],
    pub prim: [u32; WIDTH],
    pub geometry: [u32; WIDTH],
    pub instance: [[u32; WIDTH]; 2],
}

/// Which rays of a packet there are: -1 for each.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Valid(pub [c_int; WIDTH]);

/// `RTCIntersectContext` of version 3, with room for what a build of the library may append.
#[derive(Debug)]
#[repr(C)]
pub(super) struct Context3 {
    pub flags: c_int,
    pub filter: *const c_void,
    pub instance: [u32; 8],
}

/// `RTCIntersectArguments` and `RTCOccludedArguments` of version 4, with room for what a build may append.
#[derive(Debug)]
#[repr(C)]
pub(super) struct Arguments4 {
    pub flags: c_int,
    pub features: u32,
    pub context: *const c_void,
    pub filter: *const c_void,
    pub callback: *const c_void,
    pub more: [u64; 2],
}

/// `RTCMemoryMonitorFunction`.
pub(super) type MemoryMonitor =
    unsafe extern "C" fn(user: *mut c_void, bytes: isize, after: bool) -> bool;

type Query3<T> = unsafe extern "C" fn(Handle, *mut Context3, *mut T);
type Query4<T> = unsafe extern "C" fn(Handle, *mut T, *mut Arguments4);
type PacketQuery3 = unsafe extern "C" fn(*const Valid, Handle, *mut Context3, *mut Packet);
type PacketQuery4 = unsafe extern "C" fn(*const Valid, Handle, *mut Packet, *mut Arguments4);

/// The four queries of version 3.
#[derive(Debug, Clone, Copy)]
pub(super) struct Queries3 {
    pub intersect: Query3<RayHit>,
    pub occluded: Query3<RayHit>,
    pub intersect_packet: PacketQuery3,
    pub occluded_packet: PacketQuery3,
}

/// The four queries of version 4.
#[derive(Debug, Clone, Copy)]
pub(super) struct Queries4 {
    pub intersect: Query4<RayHit>,
    pub occluded: Query4<RayHit>,
    pub intersect_packet: PacketQuery4,
    pub occluded_packet: PacketQuery4,
}

/// How rays are traced; by the library's version.
#[derive(Debug, Clone, Copy)]
pub(super) enum Queries {
    V3(Queries3),
    V4(Queries4),
}

/// The functions of a library that stays loaded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Embree {
    pub new_device: unsafe extern "C" fn(*const c_char) -> Handle,
    pub release_device: unsafe extern "C" fn(Handle),
    pub device_error: unsafe extern "C" fn(Handle) -> c_int,
    pub set_memory_monitor: unsafe extern "C" fn(Handle, MemoryMonitor, *mut c_void),
    pub new_scene: unsafe extern "C" fn(Handle) -> Handle,
    pub release_scene: unsafe extern "C" fn(Handle),
    pub set_scene_flags: unsafe extern "C" fn(Handle, c_int),
    pub set_scene_quality: unsafe extern "C" fn(Handle, c_int),
    pub commit_scene: unsafe extern "C" fn(Handle),
    pub new_geometry: unsafe extern "C" fn(Handle, c_int) -> Handle,
    pub release_geometry: unsafe extern "C" fn(Handle),
    /// Geometry, kind, slot, format, stride, count.
    pub new_buffer: unsafe extern "C" fn(Handle, c_int, u32, c_int, usize, usize) -> *mut c_void,
    pub commit_geometry: unsafe extern "C" fn(Handle),
    pub attach_geometry: unsafe extern "C" fn(Handle, Handle) -> u32,
    pub queries: Queries,
}

/// File names under which systems know the library, the newer version first, and the version of each.
const NAMES: &[(&str, u32)] = if cfg!(target_os = "windows") {
    &[("embree4.dll", 4), ("embree3.dll", 3)]
} else if cfg!(target_os = "macos") {
    &[
        ("libembree4.dylib", 4),
        // Homebrew's folder on Apple's processors is not searched by itself.
        ("/opt/homebrew/lib/libembree4.dylib", 4),
        ("libembree3.dylib", 3),
        ("/opt/homebrew/lib/libembree3.dylib", 3),
    ]
} else {
    &[
        ("libembree4.so.4", 4),
        ("libembree4.so", 4),
        ("libembree3.so.3", 3),
        ("libembree3.so", 3),
    ]
};

/// What to do where the library is missing.
const REMEDY: &str = "install libembree4-4 or libembree3-3 (Debian, Ubuntu) or embree (Fedora, Arch, Homebrew), or \
                      name the library's folder in LD_LIBRARY_PATH";

/// The library, looked for at the first call.
///
/// # Errors
/// One sentence why there is none, with the remedy.
pub(super) fn library() -> Result<&'static Embree, &'static str> {
    static FOUND: OnceLock<Result<Embree, String>> = OnceLock::new();
    FOUND
        .get_or_init(|| {
            match NAMES
                .iter()
                .find_map(|(name, version)| open(name, *version))
            {
                Some(Ok(embree)) => Ok(embree),
                Some(Err(symbol)) => Err(format!(
                    "embree cannot be used: the Embree library found here lacks {symbol}; {REMEDY}"
                )),
                None => Err(format!(
                    "embree cannot be used: no Embree library was found; {REMEDY}"
                )),
            }
        })
        .as_ref()
        .map_err(String::as_str)
}

/// Opens the library called `name`, which never closes again; `None` where there is no such file, the name of a missing
/// function where it is another library.
fn open(name: &str, version: u32) -> Option<Result<Embree, &'static str>> {
    // SAFETY: loading runs the initialisers of a shared library of the system's own choice by its official name; those
    // of Embree and of the TBB that it stands on set up statics only.
    let library = unsafe { Library::new(name) }.ok()?;
    // Threads of the library's own may outlive every device, so it is never unloaded.
    let library: &'static Library = Box::leak(Box::new(library));
    Some(functions(library, version))
}

/// The functions by their names.
fn functions(library: &'static Library, version: u32) -> Result<Embree, &'static str> {
    macro_rules! function {
        ($name:literal) => {
            // SAFETY: the type is inferred from the field, which is declared as the library's documentation states it
            // for `version`; the library stays loaded, so the pointer stays valid.
            *unsafe { library.get(concat!($name, "\0")) }.map_err(|_| $name)?
        };
    }
    let queries = if version >= 4 {
        Queries::V4(Queries4 {
            intersect: function!("rtcIntersect1"),
            occluded: function!("rtcOccluded1"),
            intersect_packet: function!("rtcIntersect16"),
            occluded_packet: function!("rtcOccluded16"),
        })
    } else {
        Queries::V3(Queries3 {
            intersect: function!("rtcIntersect1"),
            occluded: function!("rtcOccluded1"),
            intersect_packet: function!("rtcIntersect16"),
            occluded_packet: function!("rtcOccluded16"),
        })
    };
    Ok(Embree {
        new_device: function!("rtcNewDevice"),
        release_device: function!("rtcReleaseDevice"),
        device_error: function!("rtcGetDeviceError"),
        set_memory_monitor: function!("rtcSetDeviceMemoryMonitorFunction"),
        new_scene: function!("rtcNewScene"),
        release_scene: function!("rtcReleaseScene"),
        set_scene_flags: function!("rtcSetSceneFlags"),
        set_scene_quality: function!("rtcSetSceneBuildQuality"),
        commit_scene: function!("rtcCommitScene"),
        new_geometry: function!("rtcNewGeometry"),
        release_geometry: function!("rtcReleaseGeometry"),
        new_buffer: function!("rtcSetNewGeometryBuffer"),
        commit_geometry: function!("rtcCommitGeometry"),
        attach_geometry: function!("rtcAttachGeometry"),
        queries,
    })
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;

    #[test]
    fn structures_lie_in_memory_as_the_library_documents_them() {
        assert_eq!((size_of::<RayHit>(), align_of::<RayHit>()), (96, 16));
        assert_eq!(offset_of!(RayHit, t_near), 12);
        assert_eq!(offset_of!(RayHit, t_far), 32);
        assert_eq!(offset_of!(RayHit, normal), 48);
        assert_eq!(offset_of!(RayHit, prim), 68);
        assert_eq!(offset_of!(RayHit, geometry), 72);
        assert_eq!(align_of::<Packet>(), 64);
        assert_eq!(offset_of!(Packet, t_far), 8 * 64);
        assert_eq!(offset_of!(Packet, normal), 12 * 64);
        assert_eq!(offset_of!(Packet, prim), 17 * 64);
        assert_eq!(offset_of!(Packet, instance), 19 * 64);
        assert_eq!(offset_of!(Context3, instance), 16);
        assert_eq!(offset_of!(Arguments4, context), 8);
    }

    #[test]
    fn a_missing_library_is_named_with_what_to_install() {
        assert!(open("no-such-library.so", 4).is_none());
        match library() {
            Ok(embree) => println!("Embree is installed here: {:?}", embree.queries),
            Err(why) => {
                println!("Embree is not installed here, so it is not tested: {why}");
                assert!(why.contains("install libembree4-4"));
            }
        }
    }
}
