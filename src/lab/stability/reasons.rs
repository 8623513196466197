//! Why kernels and exhibits fail where the suite knows that they do.

/// Why a kernel fails on these cases, unless it has a reason of its own.
pub(super) const REASONS: &[(&[&str], &str)] = &[
    (
        &["closed-edges", "closed-vertices", "closed-faces"],
        "the areas or weights of the triangles beside an edge are rounded apart, so both can exclude a ray that passes between them; in world space it grows with the offset",
    ),
    (
        &["silhouettes", "box-corners", "flat-boxes"],
        "a ray that touches an outline is beside or inside the triangle by less than a rounding of the test",
    ),
    (
        &["fan"],
        "at a hub of needle-thin triangles rays pass within a rounding of many edges at once, and of the hub's vertex",
    ),
    (
        &["slivers", "needles", "caps", "diagonal-needles"],
        "the triangle is no wider than the roundings of its corners relative to the ray, so sides and determinant are noise",
    ),
    (
        &["coplanar", "in-plane", "grazing"],
        "the ray is almost in the plane: the determinant, and so t and the weights, are noise",
    ),
    (
        &[
            "small-scales",
            "denormals",
            "depth-bomb",
            "short-directions",
        ],
        "products of two or three lengths underflow f32",
    ),
    (
        &["large-scales", "outlier", "long-directions"],
        "products of two or three lengths overflow f32",
    ),
    (
        &["far-origins", "giant"],
        "corners relative to a far origin, or the edges of a giant, carry roundings as large as the detail",
    ),
    (
        &["starts-on-surfaces", "starts-beside-surfaces"],
        "t is a rounding of 0, of either sign, so the end of the interval decides by chance",
    ),
    (
        &[
            "signed-zeros",
            "along-cell-faces",
            "along-cell-edges",
            "through-cell-corners",
            "starts-on-cell-faces",
            "split-planes-on-vertices",
        ],
        "the rays run exactly through edges and vertices, where roundings choose a side",
    ),
    (
        &["fine-cells"],
        "the specks are a millionth of the scene, hardly larger than a rounding of the crossing",
    ),
];

/// Reasons of some kernels' own.
pub(super) const OWN_REASONS: &[(&[&str], &[&str], &str)] = &[
    (
        &["pbrt"],
        &[
            "short-directions",
            "intervals",
            "triangles-on-cell-planes",
            "starts-on-cell-faces",
            "starts-on-surfaces",
            "starts-beside-surfaces",
            "fine-cells",
            "slivers",
            "needles",
            "caps",
            "far-origins",
            "through-cell-corners",
            "small-scales",
            "grazing",
            "depth-bomb",
        ],
        "a hit nearer than the bound on its own error is refused, as in pbrt: right for secondary rays, a leak by the oracle's rule",
    ),
    (
        &["sheet-unsigned", "sheet-unsigned-local"],
        &[
            "closed-edges",
            "closed-faces",
            "slivers",
            "needles",
            "caps",
            "far-origins",
            "fine-cells",
            "small-scales",
            "large-scales",
            "diagonal-needles",
            "giant",
            "outlier",
        ],
        "no eps fits: areas are rounded by more than eps of a small or far triangle, and of a thin one's",
    ),
    (
        &["moller-trumbore-eps"],
        &[
            "closed-edges",
            "closed-vertices",
            "slivers",
            "needles",
            "caps",
            "small-scales",
            "denormals",
            "short-directions",
            "grazing",
            "fine-cells",
            "depth-bomb",
        ],
        "determinants below the absolute epsilon are refused, those of all small triangles among them",
    ),
    (
        &["woop-fma"],
        &["closed-edges", "fan", "outlier"],
        "a fused edge function and its mirror image round differently, so both sides of an edge can refuse a ray",
    ),
    (
        &["havel-herout"],
        &["outlier"],
        "the planes that it stores overflow beyond 1e12",
    ),
    (
        &["baldwin-weber"],
        &["starts-beside-surfaces"],
        "the transformation that it stores is rounded in world space",
    ),
];

/// The mistake of each exhibit.
pub(super) const MISTAKES: &[(&str, &str)] = &[
    (
        "grid-incremental",
        "each addition rounds, so crossings drift apart from the cells",
    ),
    (
        "grid-inside-only",
        "a hit on the plane between two cells, or rounded beyond it, is inside neither",
    ),
    (
        "grid-f32-overlap",
        "roundings part a triangle from the cells that it lies on",
    ),
    (
        "bvh-naive-slab",
        "0 times infinity is NaN, and nothing covers the roundings of a grazed box",
    ),
];
